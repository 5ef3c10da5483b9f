// Tracers by name and by pattern.
#include "core/catalogue.h"

#include <string_view>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace {

/// '*' stands for any run of characters, '/' included.
bool matches(std::string_view pattern, std::string_view name) {
    if (pattern.empty()) return name.empty();
    if (pattern.front() != '*') {
        return !name.empty() && name.front() == pattern.front() &&
               matches(pattern.substr(1), name.substr(1));
    }
    for (size_t skip = 0; skip <= name.size(); ++skip) {
        if (matches(pattern.substr(1), name.substr(skip))) return true;
    }
    return false;
}

[[noreturn]] void throw_unknown(const std::vector<CatalogueEntry>& entries,
                                const std::string& pattern) {
    std::string names;
    for (const CatalogueEntry& entry : entries) {
        names += (names.empty() ? "" : ", ") + entry.info.name;
    }
    throw Error({"strategy name", fmt::format("'{}'", pattern),
                 entries.empty() ? "a known name (none are built in)" : "one of " + names,
                 "Give strategy[/storage[/entry]], or a pattern with '*'."});
}

}  // namespace

void Catalogue::add(CatalogueEntry entry) {
    for (const CatalogueEntry& known : entries_) {
        if (known.info.name != entry.info.name) continue;
        throw Error({"catalogue", fmt::format("a second tracer named '{}'", entry.info.name),
                     "names that differ", "Rename one of the two."});
    }
    entries_.push_back(std::move(entry));
}

std::vector<const CatalogueEntry*> Catalogue::select(const std::string& pattern) const {
    const bool all_matches = pattern.find('*') != std::string::npos;
    std::vector<const CatalogueEntry*> selected;
    for (const CatalogueEntry& entry : entries_) {
        if (all_matches) {
            if (matches(pattern, entry.info.name)) selected.push_back(&entry);
        } else if (entry.info.name == pattern || entry.info.name.starts_with(pattern + "/")) {
            return {&entry};
        }
    }
    if (selected.empty()) throw_unknown(entries_, pattern);
    return selected;
}

const CatalogueEntry& Catalogue::at(const std::string& name) const {
    for (const CatalogueEntry& entry : entries_) {
        if (entry.info.name == name) return entry;
    }
    throw_unknown(entries_, name);
}

}  // namespace onepass
