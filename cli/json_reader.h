// Reading a scene's JSON: every failure names the place, such as scene.json.bodies[0].mass.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cli/arguments.h"

namespace frm::cli {

/// An object of the file and where it is. Keys that are missing leave what they would set as it was; all failures are
/// Failure.
class JsonReader {
public:
    using Json = nlohmann::json;

    JsonReader(const Json& object, std::string where);
    /// A reader that lives longer than its object would read freed memory.
    JsonReader(Json&&, std::string) = delete;

    const std::string& where() const { return where_; }
    bool has(const std::string& key) const { return object_.contains(key); }
    /// Any other key is a failure; `of` says of what, in the message.
    void allow_only(const std::vector<std::string>& keys, const std::string& of = "") const;

    void read(const std::string& key, double& out) const;
    void read(const std::string& key, float& out) const;
    void read(const std::string& key, std::uint32_t& out) const;
    void read(const std::string& key, bool& out) const;
    void read(const std::string& key, std::string& out) const;
    void read(const std::string& key, Numbers& out) const;
    void read(const std::string& key, double (&out)[2]) const;
    /// A word that stands for a value.
    void choose(const std::string& key, std::uint32_t& out, const std::map<std::string, std::uint32_t>& choices) const;

    JsonReader object(const std::string& key) const;
    std::vector<JsonReader> list(const std::string& key) const;
    /// The names and texts of an object.
    std::map<std::string, std::string> texts(const std::string& key) const;

    [[noreturn]] void fail(const std::string& key, const std::string& text) const;

private:
    void numbers(const std::string& key, double* out, std::size_t count) const;

    const Json& object_;
    std::string where_;
};

}  // namespace frm::cli
