// Options that several commands share: what they mean is defined once.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "compare/hits.h"
#include "core/catalogue.h"

namespace onepass::cli {

struct ImageSize {
    uint32_t width = 0;
    uint32_t height = 0;
};

/// "512x384" -> {512, 384}; each side 1 to kMaxSide. Throws: Error.
ImageSize parse_size(const std::string& text);
inline constexpr uint32_t kMaxSide = 16384;

/// "NAME=VALUE" pairs. Throws: Error for another form or a name given twice.
ParamValues parse_params(const std::vector<std::string>& texts);

/// -s and --param.
struct StrategyOptions {
    std::vector<std::string> patterns;
    std::vector<std::string> params;
};
void add_strategy_options(CLI::App& command, StrategyOptions& options);

struct SelectedStrategy {
    const CatalogueEntry* entry = nullptr;
    ParamValues params;  ///< those of --param that the strategy has
};

/// The strategies that -s names, each once, in that order; without -s the defaults (see
/// default_strategies). A parameter goes to every selected strategy that has it.
/// Throws: Error for a name that matches nothing, or a parameter that no selected strategy has.
std::vector<SelectedStrategy> select_strategies(const Catalogue& catalogue,
                                                const StrategyOptions& options);

/// All strategies that are neither Embree nor a shader's twin, and are not for named use only
/// (TracerInfo::by_default); without any, Embree's fast mode.
std::vector<const CatalogueEntry*> default_strategies(const Catalogue& catalogue);

/// --rays, --size and --camera.
struct RayOptions {
    std::vector<std::string> kinds;
    std::string size = "512x512";
    uint32_t camera = 0;
};
void add_ray_options(CLI::App& command, RayOptions& options);

/// --allow. A map by class.
std::map<HitClass, uint64_t> parse_allowances(const std::vector<std::string>& texts);

/// A name as part of a file name: letters, digits, '.', '-' and '_' stay, all else becomes '-'.
std::string file_name_part(const std::string& name);

}  // namespace onepass::cli
