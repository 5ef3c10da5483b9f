#include "compare/cli/options.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include <fmt/format.h>

#include "compare/rays.h"
#include "core/error.h"

namespace onepass::cli {
namespace {

bool has_param(const TracerInfo& info, const std::string& name) {
    return std::any_of(info.params.begin(), info.params.end(),
                       [&](const ParamInfo& param) { return param.name == name; });
}

/// Reads a side's length; 0 if the text is no number from 1 to kMaxSide.
uint32_t parse_side(std::string_view text) {
    uint32_t side = 0;
    const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), side);
    const bool whole = failure == std::errc() && stop == text.data() + text.size();
    return whole && side <= kMaxSide ? side : 0;
}

}  // namespace

ImageSize parse_size(const std::string& text) {
    const size_t x = text.find('x');
    if (x != std::string::npos) {
        const ImageSize size{parse_side(std::string_view(text).substr(0, x)),
                             parse_side(std::string_view(text).substr(x + 1))};
        if (size.width > 0 && size.height > 0) return size;
    }
    throw Error({"--size", fmt::format("'{}'", text),
                 fmt::format("WIDTHxHEIGHT in pixels, each 1 to {}", kMaxSide),
                 "For example --size 512x512."});
}

ParamValues parse_params(const std::vector<std::string>& texts) {
    ParamValues values;
    for (const std::string& text : texts) {
        const size_t equals = text.find('=');
        const bool sound = equals != std::string::npos && equals > 0;
        if (!sound || !values.try_emplace(text.substr(0, equals), text.substr(equals + 1)).second) {
            throw Error({"--param", fmt::format("'{}'", text), "NAME=VALUE, each name once",
                         "'onepass list strategies' shows the names."});
        }
    }
    return values;
}

void add_strategy_options(CLI::App& command, StrategyOptions& options) {
    command
        .add_option("-s,--strategy", options.patterns,
                    "Strategy: NAME[/STORAGE[/ENTRY]] or a pattern with '*'; may be repeated. "
                    "Default: all but Embree and the twins")
        ->type_name("NAME")
        ->allow_extra_args(false);
    command
        .add_option("--param", options.params,
                    "A strategy's parameter; may be repeated ('onepass list strategies' shows "
                    "them with defaults and units)")
        ->type_name("NAME=VALUE")
        ->allow_extra_args(false);
}

std::vector<const CatalogueEntry*> default_strategies(const Catalogue& catalogue) {
    std::vector<const CatalogueEntry*> selected;
    for (const CatalogueEntry& entry : catalogue.entries()) {
        const TracerInfo& info = entry.info;
        if (info.by_default && !info.is_oracle && !info.is_twin) selected.push_back(&entry);
    }
    return selected.empty() ? catalogue.select("embree/fast") : selected;
}

std::vector<SelectedStrategy> select_strategies(const Catalogue& catalogue,
                                                const StrategyOptions& options) {
    // Names.
    std::vector<const CatalogueEntry*> entries;
    for (const std::string& pattern : options.patterns) {
        for (const CatalogueEntry* entry : catalogue.select(pattern)) {
            const bool is_new = std::find(entries.begin(), entries.end(), entry) == entries.end();
            if (is_new) entries.push_back(entry);
        }
    }
    if (options.patterns.empty()) entries = default_strategies(catalogue);

    // Parameters.
    const ParamValues given = parse_params(options.params);
    std::vector<SelectedStrategy> selected;
    for (const CatalogueEntry* entry : entries) selected.push_back({entry, {}});
    for (const auto& [name, value] : given) {
        bool used = false;
        for (SelectedStrategy& strategy : selected) {
            if (!has_param(strategy.entry->info, name)) continue;
            strategy.params[name] = value;
            used = true;
        }
        if (!used) {
            throw Error({"--param", fmt::format("'{}'", name), "a parameter of a selected strategy",
                         "'onepass list strategies' shows the names."});
        }
    }
    for (const SelectedStrategy& strategy : selected) {
        Params(strategy.entry->info.name, strategy.entry->info.params, strategy.params);
    }
    return selected;
}

void add_ray_options(CLI::App& command, RayOptions& options) {
    std::string kinds;
    for (const RayKind& kind : ray_kinds())
        kinds += fmt::format("; {}: {}", kind.name, kind.summary);
    command
        .add_option(
            "--rays", options.kinds,
            "Rays, by kind or from a file (.npy, float32, N x 8: org, tmin, dir, tmax); may "
            "be repeated" +
                kinds)
        ->type_name("KIND|FILE.npy")
        ->allow_extra_args(false)
        ->capture_default_str();
    command
        .add_option("--size", options.size,
                    "Image size in pixels; random rays are as many as pixels")
        ->type_name("WxH")
        ->capture_default_str();
    command.add_option("--camera", options.camera, "Which of the scene's cameras, from 0")
        ->capture_default_str();
}

std::map<HitClass, uint64_t> parse_allowances(const std::vector<std::string>& texts) {
    std::map<HitClass, uint64_t> allowed;
    for (const std::string& text : texts) {
        const auto [hit_class, bound] = parse_allowance(text);
        allowed[hit_class] = bound;
    }
    return allowed;
}

std::string file_name_part(const std::string& name) {
    std::string part = name;
    for (char& c : part) {
        const bool keep =
            std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_';
        if (!keep) c = '-';
    }
    return part;
}

}  // namespace onepass::cli
