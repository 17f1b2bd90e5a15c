// Configuration files: the samples are good, and every mistake is named.
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "tests/device/spidar_g.h"
#include "tests/support/library.h"

using namespace frm;
using namespace frm::test;
using Json = nlohmann::json;

namespace {

const std::string samples = FRM_TEST_SAMPLES "/devices/";

Json default_json() { return Json::parse(std::ifstream(samples + "SpidarG6X3R.json")); }

std::string refused(const Json& json, frm_status status) {
    try {
        parse_configuration(json.dump(), "c.json");
    } catch (const Error& e) {
        CHECK(e.status() == status);
        return e.text();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("the samples load, and the built-in one is SpidarG6X3R", "[spidar_g]") {
    for (const char* name : {"SpidarG6X3R", "SpidarG6X3F", "SpidarG6X4", "SpidarG645"}) {
        const Configuration c = load_configuration((samples + name + ".json").c_str());
        CHECK(c.name == name);
        CHECK(c.range.closure);
        CHECK(c.range.force > 20);
    }
    const Configuration c = load_configuration(nullptr);
    CHECK(c.name == "SpidarG6X3R");
    CHECK(c.vendor == 0x0CEC);
    CHECK(c.product == 0x0205);
    StringRows rows;
    REQUIRE(string_rows(c.geometry, {}, rows));
    CHECK(std::fabs(rows.length[0] - 0.1038) < 1e-4);
    CHECK(std::fabs(rows.length[2] - 0.1003) < 1e-4);
    // Published for SpidarG645: 22.8 N and 0.55 N m.
    const Configuration large = load_configuration((samples + "SpidarG645.json").c_str());
    CHECK(std::fabs(large.range.force - 22.8) < 0.1);
    CHECK(std::fabs(large.range.torque - 0.55) < 0.005);
}

TEST_CASE("a configuration's mistakes are named", "[spidar_g]") {
    const auto with = [](const char* pointer, const Json& value, frm_status status) {
        Json json = default_json();
        json[Json::json_pointer(pointer)] = value;
        return refused(json, status);
    };
    const auto names = [](const std::string& text, const char* part) {
        INFO(text);
        CHECK(text.find(part) != std::string::npos);
    };
    names(with("/format", "other", FRM_ERROR_CORRUPT), "c.json.format");
    names(with("/version", 2, FRM_ERROR_VERSION), "c.json.version");
    names(with("/colour", 2, FRM_ERROR_CORRUPT), "\"colour\"");
    names(with("/motors/2/colour", 2, FRM_ERROR_CORRUPT), "motors[2]");
    names(with("/lever", 0, FRM_ERROR_ARGUMENT), "c.json.lever");
    names(with("/lever", "wide", FRM_ERROR_CORRUPT), "c.json.lever");
    names(with("/motors/3/anchor/1", "a", FRM_ERROR_CORRUPT), "motors[3].anchor[1]");
    names(with("/motors/3/anchor", {1, 2}, FRM_ERROR_CORRUPT), "motors[3].anchor");
    names(with("/motors/3/anchor/1", 1e9, FRM_ERROR_ARGUMENT), "motors[3].anchor[1]");
    names(with("/motors/1/metres_per_pulse", 0, FRM_ERROR_ARGUMENT), "motors[1].metres_per_pulse");
    names(with("/motors/1/tension", {3, 2}, FRM_ERROR_ARGUMENT), "motors[1].tension");
    names(with("/motors/1/tension", {0, 2}, FRM_ERROR_ARGUMENT), "motors[1].tension");
    names(with("/motors/1/tension", {1, 900}, FRM_ERROR_ARGUMENT), "DAC");
    names(with("/amplifier", "loud", FRM_ERROR_CORRUPT), "sh4, simple");
    names(with("/bus", "hid", FRM_ERROR_CORRUPT), "vendor");
    names(with("/vendor", "XYZ", FRM_ERROR_ARGUMENT), "c.json.vendor");
    names(with("/velocity_window", 1, FRM_ERROR_ARGUMENT), "velocity_window");
    names(with("/velocity_window", 2.5, FRM_ERROR_ARGUMENT), "whole");
    names(with("/period", 0, FRM_ERROR_ARGUMENT), "c.json.period");
    names(with("/hand", {{"mass", 0}}, FRM_ERROR_ARGUMENT), "c.json.hand.mass");
    names(with("/checks", {{"residual", -1}}, FRM_ERROR_ARGUMENT), "c.json.checks.residual");
    Json json = default_json();
    json.erase("lever");
    names(refused(json, FRM_ERROR_CORRUPT), "c.json.lever is missing");
    json = default_json();
    json["motors"].erase(7);
    names(refused(json, FRM_ERROR_CORRUPT), "list of eight");
    names(refused(Json::array(), FRM_ERROR_CORRUPT), "object");
    CHECK_THROWS_AS(parse_configuration("{", "c.json"), Error);
    CHECK_THROWS_AS(load_configuration("/nonexistent/c.json"), Error);
    json = default_json();
    json["amplifier"] = "sh4", json["bus"] = "hid", json["vendor"] = "04D8", json["product"] = "003F";
    names(refused(json, FRM_ERROR_ARGUMENT), "report_bytes");
}

TEST_CASE("strings that cannot do what is needed are refused", "[spidar_g]") {
    Json json = default_json();
    // All attachments in one point: no torque, and the rotation does not show in any length.
    for (auto& motor : json["motors"]) motor["attachment"] = {0, 0, 0};
    CHECK(refused(json, FRM_ERROR_ARGUMENT).find("free in some direction") != std::string::npos);
    // All anchors above: nothing pulls down.
    json = default_json();
    for (auto& motor : json["motors"]) motor["anchor"][1] = 0.076 + 0.01 * motor["anchor"][0].get<double>();
    const std::string text = refused(json, FRM_ERROR_ARGUMENT);
    CHECK(text.find("closure") != std::string::npos);
    // One string that must pull 10 N where the others can pull 1.
    json = default_json();
    for (auto& motor : json["motors"]) motor["tension"] = {0.3, 1};
    json["motors"][0]["tension"] = {10, 20};
    CHECK(refused(json, FRM_ERROR_ARGUMENT).find("hold the grip") != std::string::npos);
}

TEST_CASE("a configuration's errors come through the C interface", "[spidar_g]") {
    const Library lib;
    const Folder folder;
    const std::string path = folder.file("bad.json");
    std::ofstream(path) << "{\"format\": \"frm-spidar-g\", \"version\": 1}";
    frm_device device = 42;
    CHECK(frm_device_open_simulated(lib.context, path.c_str(), &device) == FRM_ERROR_CORRUPT);
    CHECK(frm_device_open_simulated(lib.context, "/nonexistent.json", &device) == FRM_ERROR_FILE);
    CHECK(frm_device_open_spidar_g(lib.context, nullptr, 16, &device) == FRM_ERROR_ARGUMENT);
    CHECK(device == 42);
}
