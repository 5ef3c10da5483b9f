#include "compare/parts.h"

#include <fmt/format.h>

#include "core/error.h"

namespace onepass {
namespace fs = std::filesystem;

std::string origin_difference(const Manifest& past, const Manifest& present) {
    if (past.commit != present.commit) return "it was made by another commit";
    if (past.program_hash != present.program_hash) return "it was made by another build";
    if (past.gl_context != present.gl_context || past.gl_renderer != present.gl_renderer ||
        past.gl_version != present.gl_version) {
        return "it was made on another GL device";
    }
    if (past.cpu != present.cpu || past.cores != present.cores) return "it was made on another CPU";
    if (past.embree != present.embree) return "it was made with another Embree";
    if (past.seed != present.seed || past.arguments != present.arguments) {
        return "it was made with other options";
    }
    return "";
}

PartStore::PartStore(fs::path folder) : folder_(std::move(folder)) {
    std::error_code failure;
    fs::create_directories(folder_, failure);
    if (failure) {
        throw Error({folder_.string(), failure.message(), "a folder for the parts of the run",
                     "Choose another with -o."});
    }
}

fs::path PartStore::path_of(const std::string& step) const { return folder_ / (step + ".json"); }

FoundPart PartStore::find(const std::string& step, const Manifest& present) const {
    std::error_code ignored;
    if (!fs::exists(path_of(step), ignored)) return {};
    try {
        Results results = read_results(path_of(step));
        const std::string why_not = origin_difference(results.manifest, present);
        if (!why_not.empty()) return {std::nullopt, why_not};
        return {std::move(results), ""};
    } catch (const Error& error) {
        return {std::nullopt, fmt::format("it cannot be read ({})", error.parts().got)};
    }
}

void PartStore::save(const std::string& step, const Results& results) const {
    write_results(results, path_of(step));
}

void append_results(Results& results, const Results& part) {
    if (results.manifest.judge.empty()) results.manifest.judge = part.manifest.judge;
    for_each_list([&](const char*, auto list) {
        const auto& more = part.*list;
        (results.*list).insert((results.*list).end(), more.begin(), more.end());
    });
}

}  // namespace onepass
