// Declared parameters and the values given for them.
#include "core/params.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

/// The whole of `text` as a T; nothing if it is anything else.
template <class T>
std::optional<T> parse(const std::string& text) {
    T value{};
    const char* end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stop != end) return std::nullopt;
    return value;
}

std::optional<double> parse_real(const std::string& text) {
    const std::optional<double> value = parse<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::string joined(const std::vector<std::string>& words) {
    std::string result;
    for (const std::string& word : words) result += (result.empty() ? "" : ", ") + word;
    return result;
}

const ParamInfo* find_info(const std::vector<ParamInfo>& infos, const std::string& name) {
    const auto found = std::find_if(infos.begin(), infos.end(),
                                    [&](const ParamInfo& info) { return info.name == name; });
    return found == infos.end() ? nullptr : &*found;
}

void check_value(const std::string& owner, const ParamInfo& info, const std::string& value) {
    std::string expected;
    switch (info.type) {
        case ParamInfo::Type::real:
            if (!parse_real(value)) expected = "a finite number";
            break;
        case ParamInfo::Type::integer:
            if (!parse<long>(value)) expected = "a whole number";
            break;
        case ParamInfo::Type::choice:
            if (std::find(info.choices.begin(), info.choices.end(), value) == info.choices.end()) {
                expected = "one of " + joined(info.choices);
            }
            break;
        case ParamInfo::Type::text:
            break;
    }
    if (expected.empty()) return;
    throw Error({fmt::format("parameter {} of {}", info.name, owner), fmt::format("'{}'", value),
                 expected, fmt::format("It means: {}.", info.summary)});
}

}  // namespace

Params::Params(const std::string& owner, std::vector<ParamInfo> infos, const ParamValues& values)
    : infos_(std::move(infos)) {
    for (const auto& [name, value] : values) {
        if (find_info(infos_, name) != nullptr) continue;
        std::vector<std::string> names;
        for (const ParamInfo& info : infos_) names.push_back(info.name);
        throw Error({"parameters of " + owner, fmt::format("unknown parameter '{}'", name),
                     names.empty() ? "none" : "one of " + joined(names),
                     "`onepass list strategies` shows every strategy's parameters."});
    }
    for (const ParamInfo& info : infos_) {
        const auto given = values.find(info.name);
        const std::string& value = given == values.end() ? info.default_value : given->second;
        check_value(owner, info, value);
        values_[info.name] = value;
    }
}

double Params::real(const std::string& name) const {
    const std::optional<double> value = parse_real(text(name));
    ONEPASS_CHECK(value.has_value());
    return *value;
}

long Params::integer(const std::string& name) const {
    const std::optional<long> value = parse<long>(text(name));
    ONEPASS_CHECK(value.has_value());
    return *value;
}

const std::string& Params::text(const std::string& name) const {
    const auto found = values_.find(name);
    ONEPASS_CHECK(found != values_.end());
    return found->second;
}

}  // namespace onepass
