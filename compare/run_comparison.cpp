#include "compare/run_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include <fmt/format.h>

#include "core/random.h"

namespace onepass {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Records under a readable key; a second of the same name gets a number.
template <class Record, class KeyOf>
std::map<std::string, const Record*> by_key(const std::vector<Record>& records, KeyOf&& key_of) {
    std::map<std::string, const Record*> all;
    std::map<std::string, int> seen;
    for (const Record& record : records) {
        const std::string key = key_of(record);
        const int number = ++seen[key];
        all[number == 1 ? key : fmt::format("{} ({})", key, number)] = &record;
    }
    return all;
}

std::string case_key(const auto& record) {
    return fmt::format("{}, {}, {}", record.scene, record.rays, record.tracer);
}

std::string size_text(const SweepPoint& point) {
    const std::string top = fmt::format(", top {}", point.top_density);
    if (!point.sizes.empty()) return "sizes " + point.sizes + top;
    if (!point.resolution.empty()) return "cells " + point.resolution + top;
    return fmt::format("density {}", point.object_density) + top;
}

// ---- Speeds.

/// The rounds' ratios: speed relative to the oracle.
std::vector<double> round_ratios(const TimingRecord& record, bool by_device) {
    const std::vector<double>& ms = by_device ? record.device_ms : record.wall_ms;
    std::vector<double> ratios(std::min(ms.size(), record.oracle_wall_ms.size()));
    for (size_t i = 0; i < ratios.size(); ++i) ratios[i] = record.oracle_wall_ms[i] / ms[i];
    return ratios;
}

std::vector<double> resampled_medians(const std::vector<double>& samples, Random& random) {
    std::vector<double> drawn(samples.size()), medians(kBootstrapResamples);
    for (double& middle : medians) {
        for (double& value : drawn) value = samples[random.below(samples.size())];
        middle = median(drawn);
    }
    return medians;
}

RatioInterval interval_of(double ratio, const std::vector<double>& resampled) {
    return {ratio, quantile(resampled, 0.025), quantile(resampled, 0.975)};
}

/// Of all records of the case in this run.
double noise_of_run(const Results& run, const TimingRecord& of, uint64_t seed) {
    std::vector<const TimingRecord*> records;
    for (const TimingRecord& record : run.timings) {
        if (record.scene == of.scene && record.rays == of.rays) records.push_back(&record);
    }
    return noise_of_case(records, false, seed);  // the oracle's time is wall time
}

void conclude(SpeedChange& change, double noise_before, double noise_after) {
    change.noise_known = !std::isnan(noise_before) && !std::isnan(noise_after);
    const auto factor = [](double noise) { return std::isnan(noise) ? 1.0 : 1.0 + noise; };
    change.noise = std::isnan(noise_before) && std::isnan(noise_after)
                       ? kUnknown
                       : factor(noise_before) * factor(noise_after) - 1.0;
    change.verdict = speed_verdict(change.change, change.noise);
}

SpeedChange compare_timings(const Results& before, const TimingRecord& a, const Results& after,
                            const TimingRecord& b, uint64_t seed) {
    SpeedChange change{.scene = a.scene, .rays = a.rays, .tracer = a.tracer};
    change.errors_before = a.errors;
    change.errors_after = b.errors;
    change.by_device = !a.device_ms.empty() && !b.device_ms.empty();
    const std::vector<double> of_a = round_ratios(a, change.by_device);
    const std::vector<double> of_b = round_ratios(b, change.by_device);
    if (of_a.empty() || of_b.empty()) {
        change.before = change.after = change.change = {kUnknown, kUnknown, kUnknown};
    } else {
        Random random(seed);  // one stream: the draws of the two runs are independent
        const std::vector<double> medians_a = resampled_medians(of_a, random);
        const std::vector<double> medians_b = resampled_medians(of_b, random);
        std::vector<double> changes(kBootstrapResamples);
        for (size_t i = 0; i < changes.size(); ++i) changes[i] = medians_b[i] / medians_a[i];
        change.before = interval_of(median(of_a), medians_a);
        change.after = interval_of(median(of_b), medians_b);
        change.change = interval_of(change.after.ratio / change.before.ratio, changes);
    }
    conclude(change, noise_of_run(before, a, seed), noise_of_run(after, b, seed));
    return change;
}

SpeedChange compare_sizes(const SweepPoint& a, const SweepPoint& b) {
    SpeedChange change{.scene = a.scene, .rays = a.rays, .tracer = a.tracer, .at = size_text(a)};
    change.before = {a.ratio, a.ratio_low, a.ratio_high};
    change.after = {b.ratio, b.ratio_low, b.ratio_high};
    change.errors_before = a.errors;
    change.errors_after = b.errors;
    const auto down = [](const RatioInterval& r) { return std::log(r.ratio / r.low); };
    const auto up = [](const RatioInterval& r) { return std::log(r.high / r.ratio); };
    const double ratio = b.ratio / a.ratio;
    change.change = {ratio, ratio * std::exp(-std::hypot(down(change.after), up(change.before))),
                     ratio * std::exp(std::hypot(up(change.after), down(change.before)))};
    conclude(change, kUnknown, kUnknown);
    return change;
}

// ---- The comparison, put together.

class Comparer {
  public:
    Comparer(const Results& before, const Results& after, uint64_t seed)
        : before_(before), after_(after), seed_(seed) {}

    RunComparison run() {
        compare_surroundings();
        compare_scenes_and_rays();
        compare_structures();
        pair_up(before_.timings, after_.timings, case_key<TimingRecord>, "timing of ",
                [&](const std::string& key, const TimingRecord& a, const TimingRecord& b) {
                    if (a.tracer != a.oracle) {
                        out_.speeds.push_back(compare_timings(before_, a, after_, b, seed_));
                    }
                    compare_counts(key, a, b);
                });
        pair_up(
            before_.sweeps, after_.sweeps,
            [](const SweepPoint& p) { return case_key(p) + ", " + size_text(p); }, "size ",
            [&](const std::string& key, const SweepPoint& a, const SweepPoint& b) {
                compare_points(key, a, b);
            });
        pair_up(before_.checks, after_.checks, case_key<CheckRecord>, "check of ",
                [&](const std::string& key, const CheckRecord& a, const CheckRecord& b) {
                    compare_classes(key, a, b);
                });
        return std::move(out_);
    }

  private:
    template <class Record, class KeyOf, class Both>
    void pair_up(const std::vector<Record>& before, const std::vector<Record>& after,
                 KeyOf&& key_of, const std::string& kind, Both&& both) {
        const auto all_before = by_key(before, key_of);
        const auto all_after = by_key(after, key_of);
        for (const auto& [key, record] : all_before) {
            const auto found = all_after.find(key);
            if (found == all_after.end()) {
                out_.only_before.push_back(kind + key);
            } else {
                both(key, *record, *found->second);
            }
        }
        for (const auto& [key, record] : all_after) {
            if (!all_before.contains(key)) out_.only_after.push_back(kind + key);
        }
    }

    void count(const std::string& what, double before, double after) {
        if (before == after || (std::isnan(before) && std::isnan(after))) {
            ++out_.equal_counts;
        } else {
            out_.counts.push_back({what, before, after});
        }
    }
    void count(const std::string& what, uint64_t before, uint64_t after) {
        count(what, static_cast<double>(before), static_cast<double>(after));
    }

    void warn_unless_same(const std::string& what, const std::string& a, const std::string& b) {
        if (a != b) out_.warnings.push_back(fmt::format("{}: '{}' against '{}'", what, a, b));
    }

    void compare_surroundings() {
        const Manifest &a = before_.manifest, &b = after_.manifest;
        warn_unless_same("another CPU", a.cpu, b.cpu);
        warn_unless_same("another number of cores", std::to_string(a.cores),
                         std::to_string(b.cores));
        warn_unless_same("another renderer", a.gl_renderer, b.gl_renderer);
        warn_unless_same("another driver", a.gl_version, b.gl_version);
        warn_unless_same("another Embree", a.embree, b.embree);
        warn_unless_same("another compiler", a.compiler, b.compiler);
        warn_unless_same("another build type", a.build_type, b.build_type);
        warn_unless_same("another seed", std::to_string(a.seed), std::to_string(b.seed));
        if (!a.complete) out_.warnings.push_back("the first run was stopped before its end");
        if (!b.complete) out_.warnings.push_back("the second run was stopped before its end");
    }

    void compare_scenes_and_rays() {
        const auto name_of = [](const SceneRecord& scene) { return scene.name; };
        const auto scenes = by_key(after_.scenes, name_of);
        for (const auto& [name, scene] : by_key(before_.scenes, name_of)) {
            if (const auto same = scenes.find(name); same != scenes.end()) {
                warn_unless_same("another scene under the name " + name, scene->hash,
                                 same->second->hash);
            }
        }
        const auto rays_of = [](const CheckRecord& c) {
            return fmt::format("{}, {}", c.scene, c.rays);
        };
        std::map<std::string, std::string> hashes;
        for (const CheckRecord& check : before_.checks) hashes[rays_of(check)] = check.ray_hash;
        for (const CheckRecord& check : after_.checks) {
            const auto found = hashes.find(rays_of(check));
            if (found == hashes.end()) continue;
            warn_unless_same("other rays: " + found->first, found->second, check.ray_hash);
            hashes.erase(found);  // once for all tracers
        }
    }

    void compare_structures() {
        const auto key_of = [](const TracerRecord& t) {
            return fmt::format("{}, {}", t.scene, t.name);
        };
        pair_up(before_.tracers, after_.tracers, key_of, "tracer ",
                [&](const std::string& key, const TracerRecord& a, const TracerRecord& b) {
                    for (const auto& [name, value] : a.params) {
                        const auto same = b.params.find(name);
                        warn_unless_same(fmt::format("{}: another {}", key, name), value,
                                         same == b.params.end() ? "none" : same->second);
                    }
                    warn_unless_same(key + ": another device", a.device, b.device);
                    for (const Stat& stat : a.stats) {
                        if (stat.name.ends_with("_ms")) continue;
                        const auto same =
                            std::find_if(b.stats.begin(), b.stats.end(),
                                         [&](const Stat& s) { return s.name == stat.name; });
                        if (same != b.stats.end()) {
                            count(key + ": " + stat.name, stat.value, same->value);
                        }
                    }
                });
    }

    void compare_counts(const std::string& key, const TimingRecord& a, const TimingRecord& b) {
        count(key + ": rays", a.ray_count, b.ray_count);
        count(key + ": errors", a.errors, b.errors);
        count(key + ": edges", a.edges, b.edges);
        if (!a.counts || !b.counts) return;
        count(key + ": cells visited", a.counts->cells, b.counts->cells);
        count(key + ": tests", a.counts->tests, b.counts->tests);
        count(key + ": references read", a.counts->references, b.counts->references);
        count(key + ": repeated tests", a.counts->repeated_tests, b.counts->repeated_tests);
    }

    void compare_points(const std::string& key, const SweepPoint& a, const SweepPoint& b) {
        warn_unless_same(key, a.failure, b.failure);
        if (!a.failure.empty() || !b.failure.empty()) return;
        out_.speeds.push_back(compare_sizes(a, b));
        count(key + ": cells", a.cells, b.cells);
        count(key + ": references", a.references, b.references);
        count(key + ": bytes", a.bytes, b.bytes);
        count(key + ": cells a ray", a.cells_per_ray, b.cells_per_ray);
        count(key + ": tests a ray", a.tests_per_ray, b.tests_per_ray);
        count(key + ": errors", a.errors, b.errors);
    }

    void compare_classes(const std::string& key, const CheckRecord& a, const CheckRecord& b) {
        out_.checks_have_more_errors |= b.errors() > a.errors();
        for (size_t c = 0; c < kHitClassCount; ++c) {
            count(fmt::format("{}: {}", key, to_string(static_cast<HitClass>(c))),
                  a.classes[c].count, b.classes[c].count);
        }
        count(key + ": other triangle", a.wrong_triangle, b.wrong_triangle);
        count(key + ": exhausted", a.exhausted, b.exhausted);
    }

    const Results& before_;
    const Results& after_;
    uint64_t seed_;
    RunComparison out_;
};

}  // namespace

RunComparison compare_runs(const Results& before, const Results& after, uint64_t seed) {
    return Comparer(before, after, seed).run();
}

bool any_slower(const RunComparison& comparison) {
    return std::any_of(comparison.speeds.begin(), comparison.speeds.end(),
                       [](const auto& change) { return change.verdict == SpeedVerdict::slower; });
}

bool any_more_errors(const RunComparison& comparison) {
    return comparison.checks_have_more_errors ||
           std::any_of(comparison.speeds.begin(), comparison.speeds.end(), [](const auto& change) {
               return change.errors_after > change.errors_before;
           });
}

}  // namespace onepass
