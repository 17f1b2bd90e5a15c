#include "device/spidar_g/configuration.h"

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "device/spidar_g/default_configuration.h"

namespace frm::spidar_g {
namespace {

using Json = nlohmann::json;

/// An object of the file and where it is. A key that is missing leaves what it would set as it was.
class Reader {
public:
    Reader(const Json& object, std::string where, std::initializer_list<const char*> keys)
        : object_(object), where_(std::move(where)) {
        if (!object.is_object()) throw Error(FRM_ERROR_CORRUPT, "%s: must be an object", where_.c_str());
        for (const auto& item : object.items()) {
            bool known = item.key() == "comment";
            for (const char* key : keys) known = known || item.key() == key;
            if (!known) throw Error(FRM_ERROR_CORRUPT, "%s: unknown key \"%.60s\"", where_.c_str(), item.key().c_str());
        }
    }

    bool has(const char* key) const { return object_.contains(key); }
    const Json& at(const char* key) const {
        if (!has(key)) throw Error(FRM_ERROR_CORRUPT, "%s.%s is missing", where_.c_str(), key);
        return object_.at(key);
    }
    std::string where(const char* key) const { return where_ + "." + key; }

    void number(const char* key, double& out, double low, double high) const {
        if (has(key)) out = number_of(at(key), where(key), low, high);
    }
    void number_needed(const char* key, double& out, double low, double high) const {
        out = number_of(at(key), where(key), low, high);
    }
    template <typename T>
    void integer(const char* key, T& out, double low, double high) const {
        if (!has(key)) return;
        const double x = number_of(at(key), where(key), low, high);
        if (x != std::floor(x)) throw Error(FRM_ERROR_ARGUMENT, "%s must be a whole number", where(key).c_str());
        out = static_cast<T>(x);
    }
    void text(const char* key, std::string& out) const {
        if (!has(key)) return;
        if (!at(key).is_string()) throw Error(FRM_ERROR_CORRUPT, "%s must be a text", where(key).c_str());
        out = at(key).get<std::string>();
    }
    /// USB numbers are written in hexadecimal everywhere, which JSON has not: a text such as "0CEC".
    void usb_number(const char* key, std::uint16_t& out) const {
        if (!has(key)) return;
        std::string digits;
        text(key, digits);
        if (digits.size() != 4 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
            throw Error(FRM_ERROR_ARGUMENT, "%s must be four hexadecimal digits", where(key).c_str());
        out = static_cast<std::uint16_t>(std::stoul(digits, nullptr, 16));
    }
    void vector(const char* key, Vec3d& out, double most) const {
        if (!has(key)) return;
        const Json& list = at(key);
        if (!list.is_array() || list.size() != 3)
            throw Error(FRM_ERROR_CORRUPT, "%s must be three numbers", where(key).c_str());
        for (int i = 0; i < 3; ++i)
            out[i] =
                number_of(list[static_cast<std::size_t>(i)], where(key) + "[" + std::to_string(i) + "]", -most, most);
    }
    void bytes(const char* key, std::vector<std::uint8_t>& out, std::size_t most) const {
        if (!has(key)) return;
        const Json& list = at(key);
        if (!list.is_array() || list.size() > most)
            throw Error(FRM_ERROR_CORRUPT, "%s must be a list of at most %zu bytes", where(key).c_str(), most);
        out.clear();
        for (std::size_t i = 0; i < list.size(); ++i)
            out.push_back(
                static_cast<std::uint8_t>(number_of(list[i], where(key) + "[" + std::to_string(i) + "]", 0, 255)));
    }

private:
    static double number_of(const Json& value, const std::string& where, double low, double high) {
        if (!value.is_number()) throw Error(FRM_ERROR_CORRUPT, "%s must be a number", where.c_str());
        const auto x = value.get<double>();
        if (!(x >= low && x <= high))
            throw Error(FRM_ERROR_ARGUMENT, "%s is %g, which is not from %g to %g", where.c_str(), x, low, high);
        return x;
    }

    const Json& object_;
    std::string where_;
};

void read_motors(const Json& list, const std::string& where, Configuration& out) {
    if (!list.is_array() || list.size() != string_count)
        throw Error(FRM_ERROR_CORRUPT, "%s must be a list of eight", where.c_str());
    for (std::size_t i = 0; i < string_count; ++i) {
        const Reader r(list[i], where + "[" + std::to_string(i) + "]",
                       {"anchor", "attachment", "metres_per_pulse", "volts_per_newton", "tension"});
        r.at("anchor"), r.at("attachment");
        r.vector("anchor", out.geometry.strings[i].anchor, 10);
        r.vector("attachment", out.geometry.strings[i].attachment, 2);
        Motor& m = out.motors[i];
        r.number_needed("metres_per_pulse", m.metres_per_pulse, -1e-3, 1e-3);
        if (std::fabs(m.metres_per_pulse) < 1e-8)
            throw Error(FRM_ERROR_ARGUMENT, "%s is below 1e-8 m", r.where("metres_per_pulse").c_str());
        r.number_needed("volts_per_newton", m.volts_per_newton, 1e-4, 100);
        const Json& tension = r.at("tension");
        if (!tension.is_array() || tension.size() != 2 || !tension[0].is_number() || !tension[1].is_number())
            throw Error(FRM_ERROR_CORRUPT, "%s must be two numbers, the least and the most",
                        r.where("tension").c_str());
        const auto low = tension[0].get<double>(), high = tension[1].get<double>();
        if (!(low > 0 && low < high && high <= 1000))
            throw Error(FRM_ERROR_ARGUMENT, "%s must be 0 < least < most <= 1000 N", r.where("tension").c_str());
        if (high * m.volts_per_newton * out.digits_per_volt > 32767)
            throw Error(FRM_ERROR_ARGUMENT, "%s: %g N are beyond the 16 bits of the amplifier's DAC",
                        r.where("tension").c_str(), high);
        out.limits.low[i] = low, out.limits.high[i] = high;
    }
}

template <typename T>
T choice(const Reader& r, const char* key, std::initializer_list<std::pair<const char*, T>> choices, T otherwise) {
    if (!r.has(key)) return otherwise;
    std::string word, all;
    r.text(key, word);
    for (const auto& c : choices) {
        if (word == c.first) return c.second;
        all += std::string(all.empty() ? "" : ", ") + c.first;
    }
    throw Error(FRM_ERROR_CORRUPT, "%s is \"%.40s\"; there is: %s", r.where(key).c_str(), word.c_str(), all.c_str());
}

void read_bus(const Reader& root, Configuration& out) {
    out.amplifier =
        choice(root, "amplifier", {{"sh4", AmplifierKind::sh4}, {"simple", AmplifierKind::simple}}, AmplifierKind::sh4);
    out.bus = choice(root, "bus", {{"usb", BusKind::usb}, {"hid", BusKind::hid}}, BusKind::usb);
    out.vendor = 0x0CEC;
    out.product = out.amplifier == AmplifierKind::sh4 ? 0x0205 : 0x0203;
    root.usb_number("vendor", out.vendor);
    root.usb_number("product", out.product);
    if (out.bus == BusKind::usb) return;
    if (!root.has("vendor") || !root.has("product"))
        throw Error(FRM_ERROR_CORRUPT, "%s and .product are needed with \"bus\": \"hid\"",
                    root.where("vendor").c_str());
    root.integer("report_bytes", out.report_bytes, 32, 512);
    root.bytes("report_start", out.report_start, out.report_bytes);
    root.bytes("report_stop", out.report_stop, out.report_bytes);
    const std::uint32_t needed = out.amplifier == AmplifierKind::sh4 ? 512 : 32;
    if (out.report_bytes < needed)
        throw Error(FRM_ERROR_ARGUMENT, "%s is %u, but the amplifier's messages are %u bytes long",
                    root.where("report_bytes").c_str(), out.report_bytes, needed);
}

void read_hand(const Reader& root, Hand& out) {
    if (!root.has("hand")) return;
    const Reader r(root.at("hand"), root.where("hand"),
                   {"mass", "inertia", "stiffness", "damping", "turning_stiffness", "turning_damping", "centre",
                    "cosine", "sine", "turning", "frequency"});
    r.number("mass", out.mass, 0.01, 100);
    r.number("inertia", out.inertia, 1e-5, 100);
    r.number("stiffness", out.stiffness, 0, 1e4);
    r.number("damping", out.damping, 0, 1e3);
    r.number("turning_stiffness", out.turning_stiffness, 0, 1e3);
    r.number("turning_damping", out.turning_damping, 0, 1e2);
    r.vector("centre", out.centre, 10);
    r.vector("cosine", out.cosine, 10);
    r.vector("sine", out.sine, 10);
    r.vector("turning", out.turning, 1);
    r.number("frequency", out.frequency, 0, 20);
}

void check_strings(Configuration& c, const std::string& where) {
    StringRows rows;
    if (!string_rows(c.geometry, {}, rows))
        throw Error(FRM_ERROR_ARGUMENT, "%s.motors: a string has no length with the grip at the centre", where.c_str());
    c.range = wrench_range(rows, c.limits, c.geometry.lever);
    if (!c.range.full_rank)
        throw Error(FRM_ERROR_ARGUMENT,
                    "%s.motors: these strings leave the grip free in some direction: no pose follows from "
                    "their lengths",
                    where.c_str());
    if (!c.range.closure)
        throw Error(FRM_ERROR_ARGUMENT,
                    "%s.motors: these strings have no wrench closure: pulling, they cannot make a force and "
                    "torque of every direction",
                    where.c_str());
    if (!c.range.rest)
        throw Error(FRM_ERROR_ARGUMENT,
                    "%s.motors: within these tension limits the strings cannot hold the grip at the centre "
                    "without force",
                    where.c_str());
}

}  // namespace

Configuration parse_configuration(const std::string& text, const std::string& where) {
    Json json;
    try {
        json = Json::parse(text);
    } catch (const Json::exception& e) {
        throw Error(FRM_ERROR_CORRUPT, "%s: not JSON: %.200s", where.c_str(), e.what());
    }
    const Reader root(json, where,
                      {"format", "version", "name", "lever", "motors", "amplifier", "digits_per_volt", "bus", "vendor",
                       "product", "button_mask", "report_bytes", "report_start", "report_stop", "period", "timeout",
                       "velocity_window", "checks", "hand"});
    if (!root.has("format") || json["format"] != "frm-spidar-g")
        throw Error(FRM_ERROR_CORRUPT, "%s.format must be \"frm-spidar-g\"", where.c_str());
    std::uint32_t version = 0;
    root.at("version");
    root.integer("version", version, 0, 1e9);
    if (version != 1) throw Error(FRM_ERROR_VERSION, "%s.version is %u; this library knows 1", where.c_str(), version);
    Configuration out;
    out.name = "SPIDAR-G";
    root.text("name", out.name);
    if (out.name.empty() || out.name.size() > 40)
        throw Error(FRM_ERROR_ARGUMENT, "%s.name must be 1 to 40 bytes long", where.c_str());
    root.number_needed("lever", out.geometry.lever, 1e-3, 2);
    root.number("digits_per_volt", out.digits_per_volt, 1, 1e5);
    read_bus(root, out);
    root.integer("button_mask", out.button_mask, 0, 65535);
    double period = 0.001, timeout = 0.010;
    root.number("period", period, 1e-4, 0.1);
    root.number("timeout", timeout, 1e-3, 1);
    out.period_ns = static_cast<std::uint64_t>(period * 1e9 + 0.5);
    out.timeout_ns = static_cast<std::uint64_t>(timeout * 1e9 + 0.5);
    root.integer("velocity_window", out.velocity_window, 2, 64);
    if (root.has("checks")) {
        const Reader r(root.at("checks"), root.where("checks"), {"residual", "string_speed"});
        r.number("residual", out.checks.residual, 1e-5, 1);
        r.number("string_speed", out.checks.string_speed, 0.1, 1e3);
    }
    read_hand(root, out.hand);
    read_motors(root.at("motors"), root.where("motors"), out);
    check_strings(out, where);
    return out;
}

Configuration load_configuration(const char* path) {
    if (!path) return parse_configuration(default_configuration, "the built-in configuration");
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path, "rb"), std::fclose);
    if (!file) throw Error(FRM_ERROR_FILE, "%s: %s", path, std::strerror(errno));
    std::string text(std::size_t{1} << 20, 0);
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
    if (std::ferror(file.get())) throw Error(FRM_ERROR_FILE, "%s: cannot be read", path);
    if (text.size() == std::size_t{1} << 20) throw Error(FRM_ERROR_CORRUPT, "%s: longer than 1 MB", path);
    return parse_configuration(text, path);
}

}  // namespace frm::spidar_g
