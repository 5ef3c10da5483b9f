#include "compare/ablation.h"

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compare/statistics.h"
#include "core/error.h"

namespace onepass {
namespace {

const std::vector<double>& samples_of(const AblationRecord& record) {
    return record.device_ms.empty() ? record.wall_ms : record.device_ms;
}

}  // namespace

const std::vector<AblationStep>& ablation_steps(const std::string& strategy) {
    static const AblationStep kPersistent = {
        "persistent threads, where a GPU gains by them: rays from a queue",
        {},
        {{"persistent", "off"}}};
    static const AblationStep kAnyHit = {
        "any hit: shadow rays end at their first", {}, {{"any_hit", "0"}}};
    static const AblationStep kSpecialise = {
        "specialised shader: holds only what the scene has", {}, {{"specialise", "0"}}};
    static const std::map<std::string, std::vector<AblationStep>> kSteps = {
        {"grid",
         {{"empty cubes: empty space is crossed at once", {}, {{"skip_empty", "0"}}},
          {"small cells: the density that skipping allows", {}, {{"density", "4.5"}}},
          {"empty cubes and small cells", {}, {{"density", "4.5"}, {"skip_empty", "0"}}},
          {"boxes: an instance is walked through only if its box is met",
           {},
           {{"test_boxes", "0"}}},
          {"records of floats, the default on a GPU: nothing to unpack",
           {},
           {{"records", "fixed"}}},
          {"records of fixed-point numbers, else the default: 32 bytes",
           {},
           {{"records", "floats"}}},
          kPersistent,
          kAnyHit,
          kSpecialise,
          {"doubles: they decide where floats cannot tell", {}, {{"decide", "floats"}}},
          {"buffer textures: cells, lists and triangles", "ssbo", {}}}},
        {"bvh",
         {kPersistent, kAnyHit, kSpecialise, {"buffer textures: nodes and triangles", "ssbo", {}}}},
    };
    const auto found = kSteps.find(strategy);
    if (found != kSteps.end()) return found->second;
    std::vector<std::string> known;
    for (const auto& [name, steps] : kSteps) known.push_back(name);
    throw Error({"the steps of a strategy", "'" + strategy + "'",
                 fmt::format("one of {}", fmt::join(known, ", ")),
                 "Its steps are listed in compare/ablation.cpp."});
}

std::string tracer_without(const std::string& tracer, const AblationStep& step) {
    if (step.storage.empty()) return tracer;
    const size_t first = tracer.find('/');
    const size_t last = tracer.rfind('/');
    ONEPASS_CHECK(first != std::string::npos && first < last);
    return tracer.substr(0, first + 1) + step.storage + tracer.substr(last);
}

void compare_ablations(std::span<AblationRecord> records, uint64_t seed) {
    ONEPASS_CHECK(!records.empty());
    for (AblationRecord& record : records) {
        if (!record.failure.empty()) continue;
        const RatioInterval r =
            ratio_of_medians(samples_of(records.front()), samples_of(record), seed);
        record.ratio = r.ratio, record.ratio_low = r.low, record.ratio_high = r.high;
    }
}

double median_ms(const AblationRecord& record) { return median(samples_of(record)); }

double mrays_per_s(const AblationRecord& record) {
    return static_cast<double>(record.rays) / (1e3 * median_ms(record));
}

}  // namespace onepass
