#include "compare/study.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compare/parts.h"
#include "core/error.h"

namespace onepass {
namespace {

namespace fs = std::filesystem;

/// A whole number from 1 on; 0 if the text is none.
uint32_t parse_count(std::string_view text) {
    uint32_t number = 0;
    const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
    return failure == std::errc() && stop == text.data() + text.size() ? number : 0;
}

std::vector<std::string> without_repeats(const std::vector<std::string>& words) {
    std::vector<std::string> unique;
    std::set<std::string> seen;
    for (const std::string& word : words) {
        if (seen.insert(word).second) unique.push_back(word);
    }
    return unique;
}

// What records points may share: those of one identity are one. Others have none.

template <class Record>
std::string identity(const Record&) {
    return {};
}
std::string identity(const SceneRecord& scene) { return scene.name; }
std::string identity(const TracerRecord& tracer) {
    return fmt::format("{}\n{}\n{}", tracer.scene, tracer.name, fmt::join(tracer.params, "\n"));
}
std::string identity(const BuildRecord& build) {
    return fmt::format("{}\n{}", build.scene, build.tracer);
}
std::string identity(const RefusalRecord& refusal) {
    return fmt::format("{}\n{}\n{}", refusal.scene, refusal.tracer, refusal.reason);
}

[[noreturn]] void refuse_scene(const std::string& name, const std::string& past,
                               const std::string& present) {
    throw Error({fmt::format("scene '{}'", name), fmt::format("content of hash {}", present),
                 fmt::format("hash {}, as in the points that are finished", past),
                 "Put the scene back as it was, or start the study anew in another file."});
}

void check_same_scene(const SceneRecord& past, const SceneRecord& present) {
    if (past.name == present.name && past.hash != present.hash) {
        refuse_scene(past.name, past.hash, present.hash);
    }
}

/// Puts the records of one list behind those of another, each identity once, and says where each
/// of them is now.
template <class Record>
std::vector<uint32_t> append_rows(std::vector<Record>& all, const std::vector<Record>& more,
                                  std::map<std::string, uint32_t>& known) {
    std::vector<uint32_t> rows;
    for (const Record& record : more) {
        const auto next = static_cast<uint32_t>(all.size());
        const std::string name = identity(record);
        const auto found = name.empty() ? known.end() : known.find(name);
        if (found != known.end()) {
            rows.push_back(found->second);
            if constexpr (std::is_same_v<Record, SceneRecord>) {
                check_same_scene(all[found->second], record);
            }
            continue;
        }
        if (!name.empty()) known[name] = next;
        rows.push_back(next);
        all.push_back(record);
    }
    return rows;
}

[[noreturn]] void refuse_study(const std::string& file, const std::string& got) {
    throw Error(
        {file + ": study", got, "keys, lists and rows that are there", "Make the file again."});
}

/// Why the unfinished study of a file cannot be gone on with; empty if it can.
std::string difference(const Results& past, const StudyRequest& request) {
    Manifest then = past.manifest, now = request.manifest;
    then.arguments = request_of(then.arguments);
    now.arguments = request_of(now.arguments);
    if (!past.study->parts.empty()) return "it was merged from shards";
    if (then.arguments != now.arguments) {
        return fmt::format("it was begun as '{}'", fmt::join(past.manifest.arguments, " "));
    }
    if (then.seed != now.seed) return fmt::format("it was begun with --seed {}", then.seed);
    if (const std::string why = origin_difference(then, now); !why.empty()) return why;
    if (past.study->shard != request.shard) {
        return fmt::format("it is shard {}, not {}", to_string(past.study->shard),
                           to_string(request.shard));
    }
    return past.study->keys == request.keys ? "" : "its points are others";
}

}  // namespace

Shard parse_shard(const std::string& text) {
    const size_t slash = text.find('/');
    if (slash != std::string::npos) {
        const Shard shard{parse_count(std::string_view(text).substr(0, slash)),
                          parse_count(std::string_view(text).substr(slash + 1))};
        if (shard.index >= 1 && shard.index <= shard.count) return shard;
    }
    throw Error({"--shard", fmt::format("'{}'", text), "I/N with I from 1 to N",
                 "For example --shard 2/4, the second of four."});
}

std::string to_string(const Shard& shard) { return fmt::format("{}/{}", shard.index, shard.count); }

bool takes(const Shard& shard, size_t point) { return point % shard.count + 1 == shard.index; }

std::vector<std::string> request_of(const std::vector<std::string>& arguments) {
    std::vector<std::string> request;
    for (size_t i = 0; i < arguments.size(); ++i) {
        const std::string& word = arguments[i];
        const auto is = [&](const std::string& option) {
            if (word == option) return ++i, true;  // and its value
            return word.starts_with(option + "=");
        };
        if (!is("--shard") && !is("--json")) request.push_back(word);
    }
    return request;
}

Results join_points(const std::vector<std::string>& keys,
                    const std::map<std::string, Results>& points) {
    Results all;
    all.study.emplace().keys = keys;
    std::map<std::string, std::map<std::string, uint32_t>> known;  // by list and identity
    for (const std::string& key : keys) {
        const auto found = points.find(key);
        if (found == points.end()) continue;
        const Results& part = found->second;
        if (all.manifest.judge.empty()) all.manifest.judge = part.manifest.judge;
        StudyPoint point{key, {}};
        for_each_list([&](const char* name, auto list) {
            ListRows rows{name, append_rows(all.*list, part.*list, known[name])};
            if (!rows.rows.empty()) point.records.push_back(std::move(rows));
        });
        all.study->points.push_back(std::move(point));
    }
    return all;
}

std::map<std::string, Results> split_points(const Results& results, const std::string& file) {
    ONEPASS_CHECK(results.study.has_value());
    const StudyRecord& study = *results.study;
    const std::set<std::string> keys(study.keys.begin(), study.keys.end());
    std::map<std::string, Results> points;
    for (const StudyPoint& point : study.points) {
        if (!keys.contains(point.key)) {
            refuse_study(file, fmt::format("the unknown point '{}'", point.key));
        }
        Results& part = points[point.key];
        part.manifest = results.manifest;
        for (const ListRows& rows : point.records) {
            bool known = false;
            for_each_list([&](const char* name, auto list) {
                if (rows.list != name) return;
                known = true;
                for (const uint32_t row : rows.rows) {
                    if (row >= (results.*list).size()) {
                        refuse_study(file, fmt::format("row {} of '{}', which has {}", row, name,
                                                       (results.*list).size()));
                    }
                    (part.*list).push_back((results.*list)[row]);
                }
            });
            if (!known) refuse_study(file, fmt::format("the unknown list '{}'", rows.list));
        }
    }
    return points;
}

Study::Study(StudyRequest request) : request_(std::move(request)) {
    request_.keys = without_repeats(request_.keys);
    for (size_t k = 0; k < request_.keys.size(); ++k) {
        if (takes(request_.shard, k)) mine_.push_back(request_.keys[k]);
    }
    if (request_.file == "-") request_.file.clear();
    std::error_code ignored;
    if (!request_.file.empty() && fs::exists(request_.file, ignored)) take_up();
}

void Study::take_up() {
    const std::string file = request_.file.string();
    Results past;
    try {
        past = read_results(request_.file);
    } catch (const Error&) {
        return;  // no study, then
    }
    if (past.manifest.complete || !past.study) return;
    if (const std::string why = difference(past, request_); !why.empty()) {
        throw Error({file, "an unfinished study of another run: " + why,
                     "one that this very command began, with this build on this machine",
                     "Finish it as it was begun, name another file with --json, or remove it."});
    }
    std::ifstream bytes(request_.file, std::ios::binary);
    const Seal seal = seal_of({std::istreambuf_iterator<char>(bytes), {}}, file);
    if (!seal.intact()) {
        throw Error({file, "an unfinished study that was edited: its digest is not of its content",
                     "the file as its run left it", "Remove it, and start anew."});
    }
    done_ = split_points(past, file);
    kept_ = done_.size();
}

bool Study::needs(const std::string& key) const {
    return !done_.contains(key) && std::find(mine_.begin(), mine_.end(), key) != mine_.end();
}

void Study::check_scene(const SceneRecord& scene) const {
    for (const auto& [key, point] : done_) {
        for (const SceneRecord& past : point.scenes) check_same_scene(past, scene);
    }
}

void Study::add(const std::string& key, Results point) {
    ONEPASS_CHECK(needs(key));
    done_[key] = std::move(point);
    if (!request_.file.empty()) write_results(results(), request_.file);
}

Results Study::results() const {
    Results all = join_points(request_.keys, done_);
    const std::string judge = all.manifest.judge;
    all.manifest = request_.manifest;
    all.manifest.judge = judge;
    all.manifest.complete = finished();
    all.study->shard = request_.shard;
    return all;
}

}  // namespace onepass
