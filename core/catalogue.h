// The list of all tracers, made by name. Built once by `main` (or a test) from each module's list.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/params.h"
#include "core/tracer.h"

namespace onepass {

using ScenePtr = std::shared_ptr<const Scene>;

/// A place where a strategy departs from its source, or keeps a behaviour of it that costs
/// accuracy, behind a switch.
struct Deviation {
    std::string id;       ///< "D11"; unique within a strategy
    std::string param;    ///< the parameter that switches it off ...
    std::string value;    ///< ... by this value
    std::string summary;  ///< one line

    bool operator==(const Deviation&) const = default;
};

struct TracerInfo {
    std::string name;     ///< strategy/storage/entry
    std::string summary;  ///< one line
    std::string source;   ///< paper, figure
    std::vector<ParamInfo> params;
    std::vector<Deviation> deviations;  ///< in the order in which errors are attributed to them
    bool is_oracle = false;             ///< an Embree tracer
    bool is_twin = false;               ///< a shader's text run as C++
    bool by_default = true;             ///< one of those that a command takes if it is told none
};

struct CatalogueEntry {
    TracerInfo info;
    /// Throws: Error if the scene exceeds the strategy's limits, or the device is not usable.
    std::function<std::unique_ptr<Tracer>(ScenePtr, const ParamValues&)> make;
};

class Catalogue {
  public:
    /// Throws: Error if the name is taken.
    void add(CatalogueEntry entry);

    const std::vector<CatalogueEntry>& entries() const { return entries_; }

    /// Entries by pattern: a full name; a strategy or strategy/storage, which stands for its first
    /// entry; or a pattern with '*' (any characters), which stands for every match.
    /// Throws: Error listing the known names if nothing matches.
    std::vector<const CatalogueEntry*> select(const std::string& pattern) const;

    const CatalogueEntry& at(const std::string& name) const;

  private:
    std::vector<CatalogueEntry> entries_;
};

}  // namespace onepass
