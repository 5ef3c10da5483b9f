#include "compare/merge.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compare/study.h"
#include "core/error.h"

namespace onepass {
namespace {

namespace fs = std::filesystem;

constexpr char kRemakeRemedy[] = "Merge shards of one command, made by one commit.";

void check_is_study(const ShardFile& file) {
    if (file.results.study) return;
    throw Error({file.name, "results that are not made of points", "a shard of a study",
                 "Make it with --shard I/N and --json (see onepass bench --help)."});
}

/// What two files of one study must have in common.
void check_same_study(const ShardFile& first, const ShardFile& other) {
    const auto refuse = [&](const std::string& got, const std::string& expected) {
        throw Error(
            {other.name, got, fmt::format("{}, as in {}", expected, first.name), kRemakeRemedy});
    };
    const Manifest &a = first.results.manifest, &b = other.results.manifest;
    const std::string asked = fmt::format("{}", fmt::join(request_of(a.arguments), " "));
    const std::string asked_other = fmt::format("{}", fmt::join(request_of(b.arguments), " "));
    if (asked != asked_other) refuse("'" + asked_other + "'", "'" + asked + "'");
    if (a.seed != b.seed) refuse(fmt::format("seed {}", b.seed), fmt::format("seed {}", a.seed));
    if (a.commit != b.commit) refuse("commit " + b.commit, "commit " + a.commit);
    if ((a.dirty || b.dirty) && a.program_hash != b.program_hash) {
        refuse("a build with uncommitted changes", "the same build");
    }
    if (first.results.study->keys != other.results.study->keys) refuse("other points", "the same");
}

std::vector<StudyPart> parts_of(const Results& results) {
    if (!results.study->parts.empty()) return results.study->parts;
    return {{results.study->shard, results.manifest}};
}

/// By shard, and then by anything, so that the order of the files does not show.
bool comes_before(const StudyPart& a, const StudyPart& b) {
    const auto rank = [](const StudyPart& p) {
        return std::tie(p.shard.count, p.shard.index, p.manifest.time_utc, p.manifest.cpu,
                        p.manifest.arguments);
    };
    return rank(a) < rank(b);
}

/// One text where all agree, else all of them.
std::string joined(const std::vector<StudyPart>& parts, std::string Manifest::*field) {
    std::set<std::string> texts;
    for (const StudyPart& part : parts) {
        if (!(part.manifest.*field).empty()) texts.insert(part.manifest.*field);
    }
    return fmt::format("{}", fmt::join(texts, " | "));
}

Manifest common_manifest(const std::vector<StudyPart>& parts) {
    Manifest all = parts.front().manifest;
    all.arguments = request_of(all.arguments);
    for (const auto field : {&Manifest::program_hash, &Manifest::build_type, &Manifest::compiler,
                             &Manifest::cpu, &Manifest::gl_context, &Manifest::gl_renderer,
                             &Manifest::gl_version, &Manifest::embree, &Manifest::judge}) {
        all.*field = joined(parts, field);
    }
    for (const StudyPart& part : parts) {
        const Manifest& m = part.manifest;
        if (m.cores != all.cores) all.cores = 0;
        all.time_utc = std::max(all.time_utc, m.time_utc);
        all.dirty |= m.dirty;
        all.software_renderer |= m.software_renderer;
    }
    return all;
}

constexpr size_t kMostNamed = 4;

/// "no results of 2 of 12 points; shard 2/4; 'a, x'; 'b, x'".
std::string missing_text(const std::vector<std::string>& keys,
                         const std::map<std::string, Results>& points,
                         const std::vector<StudyPart>& parts) {
    const uint32_t count = parts.front().shard.count;
    const bool alike = std::all_of(parts.begin(), parts.end(),
                                   [&](const auto& part) { return part.shard.count == count; });
    std::map<uint32_t, std::vector<std::string>> missing;  // by shard; 0: the shards are unlike
    size_t total = 0;
    for (size_t k = 0; k < keys.size(); ++k) {
        if (points.contains(keys[k])) continue;
        missing[alike ? static_cast<uint32_t>(k) % count + 1 : 0].push_back(keys[k]);
        ++total;
    }
    std::string text = fmt::format("no results of {} of {} points", total, keys.size());
    for (const auto& [index, own] : missing) {
        if (index > 0) text += fmt::format("; shard {}/{}", index, count);
        const size_t named = std::min(own.size(), kMostNamed);
        for (size_t i = 0; i < named; ++i) text += fmt::format("; '{}'", own[i]);
        if (named < own.size()) text += fmt::format(" and {} more", own.size() - named);
    }
    return text;
}

}  // namespace

Results merge_shards(const std::vector<ShardFile>& files, bool partial) {
    ONEPASS_CHECK(!files.empty());
    for (const ShardFile& file : files) check_is_study(file);
    for (const ShardFile& file : files) check_same_study(files.front(), file);

    // The points, each from one file.
    std::map<std::string, Results> points;
    std::map<std::string, std::string> owner;
    std::vector<StudyPart> parts;
    for (const ShardFile& file : files) {
        for (auto& [key, point] : split_points(file.results, file.name)) {
            if (!owner.try_emplace(key, file.name).second) {
                throw Error({file.name, fmt::format("point '{}'", key),
                             fmt::format("points that are not in {}", owner[key]),
                             "Name each shard once."});
            }
            points[key] = std::move(point);
        }
        const std::vector<StudyPart> own = parts_of(file.results);
        parts.insert(parts.end(), own.begin(), own.end());
    }
    std::sort(parts.begin(), parts.end(), comes_before);

    // All of them?
    const std::vector<std::string>& keys = files.front().results.study->keys;
    const bool complete = points.size() == keys.size();
    if (!complete && !partial) {
        throw Error({"onepass merge", missing_text(keys, points, parts), "every point once",
                     "Finish these shards and name their files, or allow gaps with --partial."});
    }

    Results all = join_points(keys, points);
    all.manifest = common_manifest(parts);
    all.manifest.complete = complete;
    all.study->parts = std::move(parts);
    return all;
}

bool like_machines(const Manifest& a, const Manifest& b) {
    const auto machine = [](const Manifest& m) {
        return std::tie(m.cpu, m.cores, m.gl_context, m.gl_renderer, m.gl_version, m.embree);
    };
    return machine(a) == machine(b);
}

void move_pictures(Results& results, const fs::path& from, const fs::path& to) {
    const auto here_if_empty = [](const fs::path& folder) {
        return fs::absolute(folder.empty() ? "." : folder).lexically_normal();
    };
    const fs::path base = here_if_empty(to), start = here_if_empty(from);
    const auto move = [&](std::string& path) {
        if (path.empty()) return;
        path = (start / path).lexically_normal().lexically_relative(base).string();
    };
    for (CheckRecord& check : results.checks) move(check.picture);
    for (ImageRecord& image : results.images) {
        for (auto& [role, path] : image.pictures) move(path);
    }
    for (PixelSheetRecord& sheet : results.pixel_sheets) move(sheet.file);
}

}  // namespace onepass
