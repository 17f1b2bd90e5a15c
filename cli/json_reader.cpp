#include "cli/json_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cli/command.h"

namespace frm::cli {

JsonReader::JsonReader(const Json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) throw Failure(where_ + ": an object is needed");
}

void JsonReader::allow_only(const std::vector<std::string>& keys, const std::string& of) const {
    for (const auto& [key, ignored] : object_.items())
        if (std::find(keys.begin(), keys.end(), key) == keys.end())
            fail(key, "not known " + (of.empty() ? "here" : "for " + of));
}

void JsonReader::read(const std::string& key, double& out) const {
    if (!has(key)) return;
    if (!object_[key].is_number()) fail(key, "a number is needed");
    out = object_[key].get<double>();
}

void JsonReader::read(const std::string& key, float& out) const {
    double v = static_cast<double>(out);
    read(key, v);
    if (std::fabs(v) > static_cast<double>(std::numeric_limits<float>::max())) fail(key, "is far too large");
    out = static_cast<float>(v);
}

void JsonReader::read(const std::string& key, std::uint32_t& out) const {
    double v = out;
    read(key, v);
    if (!(v >= 0 && v <= 1e9) || v != std::floor(v)) fail(key, "a whole number is needed");
    out = static_cast<std::uint32_t>(v);
}

void JsonReader::read(const std::string& key, bool& out) const {
    if (!has(key)) return;
    if (!object_[key].is_boolean()) fail(key, "true or false is needed");
    out = object_[key].get<bool>();
}

void JsonReader::read(const std::string& key, std::string& out) const {
    if (!has(key)) return;
    if (!object_[key].is_string()) fail(key, "a text is needed");
    out = object_[key].get<std::string>();
}

void JsonReader::read(const std::string& key, Numbers& out) const { numbers(key, out.data(), 3); }
void JsonReader::read(const std::string& key, double (&out)[2]) const { numbers(key, out, 2); }

void JsonReader::numbers(const std::string& key, double* out, std::size_t count) const {
    if (!has(key)) return;
    const Json& v = object_[key];
    bool good = v.is_array() && v.size() == count;
    for (std::size_t i = 0; good && i < count; ++i) good = v[i].is_number();
    if (!good) fail(key, std::string(count == 2 ? "two" : "three") + " numbers are needed");
    for (std::size_t i = 0; i < count; ++i) {
        out[i] = v[i].get<double>();
        if (std::fabs(out[i]) > 1e9) fail(key, "is beyond 1e9");
    }
}

void JsonReader::choose(const std::string& key, std::uint32_t& out,
                        const std::map<std::string, std::uint32_t>& choices) const {
    if (!has(key)) return;
    std::string word, all;
    read(key, word);
    for (const auto& [name, ignored] : choices) all += (all.empty() ? "" : ", ") + name;
    const auto found = choices.find(word);
    if (found == choices.end()) fail(key, "\"" + word + "\" is not one of " + all);
    out = found->second;
}

JsonReader JsonReader::object(const std::string& key) const { return {object_.at(key), where_ + "." + key}; }

std::vector<JsonReader> JsonReader::list(const std::string& key) const {
    if (!has(key) || !object_[key].is_array()) fail(key, "a list is needed");
    std::vector<JsonReader> all;
    for (const Json& one : object_[key])
        all.push_back({one, where_ + "." + key + "[" + std::to_string(all.size()) + "]"});
    return all;
}

std::map<std::string, std::string> JsonReader::texts(const std::string& key) const {
    std::map<std::string, std::string> all;
    if (!has(key)) return all;
    const JsonReader inside = object(key);
    for (const auto& [name, ignored] : inside.object_.items()) inside.read(name, all[name]);
    return all;
}

void JsonReader::fail(const std::string& key, const std::string& text) const {
    throw Failure(where_ + "." + key + ": " + text);
}

}  // namespace frm::cli
