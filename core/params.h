// Parameters of a tracer: `--param NAME=VALUE`, declared with type, default and unit.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace onepass {

struct ParamInfo {
    enum class Type { real, integer, choice, text };
    std::string name;
    Type type = Type::real;
    std::string default_value;
    std::string summary;               ///< one line, with the unit
    std::vector<std::string> choices;  ///< of a `choice`

    bool operator==(const ParamInfo&) const = default;
};

/// Values by name as the user gave them.
using ParamValues = std::map<std::string, std::string>;

/// Declared parameters with their values; defaults filled in, everything checked.
class Params {
  public:
    /// Throws: Error naming `owner` for an unknown name, an ill-typed value or an unknown choice.
    Params(const std::string& owner, std::vector<ParamInfo> infos, const ParamValues& values);

    double real(const std::string& name) const;
    long integer(const std::string& name) const;
    const std::string& text(const std::string& name) const;

    const std::vector<ParamInfo>& infos() const { return infos_; }
    /// All values, defaults included: what a result's manifest records.
    const ParamValues& values() const { return values_; }

  private:
    std::vector<ParamInfo> infos_;
    ParamValues values_;
};

}  // namespace onepass
