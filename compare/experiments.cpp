#include "compare/experiments.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "compare/frame_timing.h"
#include "compare/hits.h"
#include "compare/manifest.h"
#include "compare/rays.h"
#include "core/error.h"
#include "core/random.h"

namespace onepass {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;
constexpr double kGiB = 1024.0 * kMiB;

/// An image that a frame leaves: four floats a pixel, whatever else it moved.
constexpr double kImageBytesPerPixel = 16.0;

// ---- One experiment
// ------------------------------------------------------------------------------

/// A scene in one form, with the truth about the experiment's rays.
struct Stage {
    ScenePtr scene;
    Referees referees;
    CastResult truth;
};

/// One setting made ready.
struct Side {
    Setting setting;
    std::unique_ptr<Tracer> tracer;  ///< null after a failure
    std::string failure;
    bool known = false;  ///< scene and tracer exist: a failure is a refusal
    uint64_t errors = 0;
};

/// Samples of all sides, by side; the last list is the baseline's second run.
using Samples = std::vector<std::vector<double>>;

bool same_setting(const Setting& a, const Setting& b) {
    return a.tracer == b.tracer && a.params == b.params && a.form == b.form;
}

class ExperimentRun {
  public:
    ExperimentRun(const Experiment& experiment, const std::string& entry, const Workshop& workshop,
                  const Progress& progress)
        : experiment_(experiment), entry_(entry), workshop_(workshop), progress_(progress) {}

    std::vector<ClaimMeasurement> measurements;
    std::vector<FrameTimingRecord> frame_timings;

    /// False if it was stopped.
    bool run() {
        prepare();
        if (!go_on(progress_, 0.0)) return false;
        if (sides_.front().failure.empty()) {
            if (experiment_.work == "animation") {
                animate();
            } else {
                for (const Probe& probe : experiment_.probes) measure(probe);
            }
        }
        if (!go_on(progress_, 1.0)) return false;
        conclude();
        return true;
    }

  private:
    // ---- Making the sides.

    void prepare() {
        sides_.push_back({experiment_.baseline, nullptr, {}, false, 0});
        for (const Setting& variant : experiment_.variants) {
            sides_.push_back({variant, nullptr, {}, false, 0});
        }
        for (Side& side : sides_) {
            try {
                make(side);
            } catch (const Error& error) {
                side.tracer = nullptr;
                side.failure = error.what();
            }
        }
    }

    void make(Side& side) {
        Stage& stage = stage_of(side.setting.form);
        const CatalogueEntry& entry = workshop_.catalogue->at(tracer_name(side.setting));
        Params(entry.info.name, entry.info.params, side.setting.params);
        side.known = true;
        side.tracer = entry.make(stage.scene, side.setting.params);
        const CastResult answers =
            side.tracer->cast(side.tracer->upload(rays_.rays), {.query = rays_.query});
        side.errors = compare_hits(rays_.rays, rays_.query, answers, stage.truth,
                                   *stage.referees.judge, {.seed = workshop_.timing.seed})
                          .record.errors();
    }

    std::string tracer_name(const Setting& setting) const {
        const std::string& name = setting.tracer;
        return name.ends_with("/*") ? name.substr(0, name.size() - 1) + entry_ : name;
    }

    Stage& stage_of(SceneForm form) {
        if (const auto known = stages_.find(form); known != stages_.end()) return known->second;
        Stage stage;
        stage.scene = workshop_.scene(experiment_.scene, form);
        stage.referees = workshop_.referees(stage.scene);
        Tracer& oracle = *stage.referees.oracle;
        if (rays_.rays.empty()) {  // the first side's form decides; all forms show the same
            const bool is_ray_kind = experiment_.work != "image" && experiment_.work != "animation";
            rays_ = make_ray_set(is_ray_kind ? experiment_.work : "primary", *stage.scene, oracle,
                                 {side_length(), side_length(), 0, workshop_.timing.seed});
        }
        stage.truth = oracle.cast(oracle.upload(rays_.rays), {.query = rays_.query});
        return stages_.emplace(form, std::move(stage)).first->second;
    }

    uint32_t side_length() const { return image_side(workshop_, experiment_); }

    // ---- Measuring.

    ClaimMeasurement blank(const Probe& probe, const Side& variant) const {
        const Side& baseline = sides_.front();
        ClaimMeasurement m;
        m.scene = experiment_.scene;
        m.work = experiment_.work;
        m.quantity = to_string(probe.quantity);
        m.unit = unit_of(probe.quantity);
        m.baseline = label_of(baseline.setting);
        m.variant = label_of(variant.setting);
        m.size = variant.setting.size;
        m.expectation = probe.expectation;
        m.bound = probe.bound;
        m.rays = rays_.rays.size();
        m.baseline_errors = baseline.errors;
        m.variant_errors = variant.errors;
        m.failure = !baseline.failure.empty() ? baseline.failure : variant.failure;
        return m;
    }

    void measure(const Probe& probe) {
        const Samples samples = samples_of(probe.quantity);
        for (size_t i = 1; i < sides_.size(); ++i) {
            ClaimMeasurement m = blank(probe, sides_[i]);
            if (m.failure.empty()) {
                m.baseline_samples = samples.front();
                m.variant_samples = samples[i];
                m.again_samples = samples.back();
            }
            measurements.push_back(std::move(m));
        }
    }

    Samples samples_of(Quantity quantity) {
        switch (quantity) {
            case Quantity::time:
                return experiment_.work == "image" ? frame_times() : cast_times();
            case Quantity::memory:
                return counted([](const Side& side) {
                    const std::vector<Stat> stats = side.tracer->stats();
                    const double bytes = stat_value(stats, "device_bytes");
                    return (bytes > 0.0 ? bytes : stat_value(stats, "bytes")) / kMiB;
                });
            case Quantity::errors:
                return counted([](const Side& side) { return static_cast<double>(side.errors); });
            case Quantity::traffic:
                return counted([this](const Side& side) { return traffic(*side.tracer) / kMiB; });
            case Quantity::build:
                return build_times();
            case Quantity::bandwidth:
                return bandwidths();
            case Quantity::update:
                break;
        }
        throw Error({experiment_.scene, "an update without an animation", "work 'animation'",
                     "Mend the claim's experiment."});
    }

    template <class Count>
    Samples counted(Count&& count) const {
        Samples samples(sides_.size() + 1);
        for (size_t i = 0; i < sides_.size(); ++i) {
            if (sides_[i].tracer) samples[i] = {count(sides_[i])};
        }
        return samples;
    }

    /// The tracers that are there, the baseline once more at the end.
    std::vector<Tracer*> contestants() const {
        std::vector<Tracer*> all;
        for (const Side& side : sides_) {
            if (side.tracer) all.push_back(side.tracer.get());
        }
        all.push_back(all.front());
        return all;
    }

    template <class Record>
    Samples by_side(const std::vector<Record>& records) const {
        Samples samples(sides_.size() + 1);
        size_t next = 0;
        for (size_t i = 0; i < sides_.size(); ++i) {
            if (sides_[i].tracer) samples[i] = records[next++].wall_ms;
        }
        samples.back() = records[next].wall_ms;
        return samples;
    }

    Samples cast_times() const {
        return by_side(time_casts(contestants(), 0, rays_, workshop_.timing, progress_));
    }

    FrameRequest frame_request() const {
        const RenderSettings settings{.width = side_length(), .height = side_length()};
        return {stages_.begin()->second.scene->cameras.at(0), settings, {}};
    }

    Samples frame_times() {
        const auto records =
            time_frames(contestants(), 0, frame_request(), workshop_.timing, progress_);
        keep_frame_timings(records, [](const FrameTimingRecord& r) { return !r.costs.empty(); });
        return by_side(records);
    }

    double traffic(Tracer& tracer) const {
        RenderSettings settings = frame_request().settings;
        settings.aovs = false;
        const Frame frame = tracer.render(frame_request().camera, settings);
        const double pixels = static_cast<double>(settings.width) * settings.height;
        return stat_value(frame.costs, "state_bytes_read") +
               stat_value(frame.costs, "state_bytes_written") + kImageBytesPerPixel * pixels;
    }

    Samples build_times() const {
        Samples samples(sides_.size() + 1);
        Random random(workshop_.timing.seed);
        std::vector<size_t> order(samples.size());
        for (uint32_t round = 0; round < workshop_.timing.repetitions; ++round) {
            if (!go_on(progress_, 0.5)) break;
            std::iota(order.begin(), order.end(), size_t{0});
            random.shuffle(std::span(order));
            for (const size_t i : order) {
                const Side& side = sides_[i % sides_.size()];
                if (!side.tracer) continue;
                const auto tracer =
                    workshop_.catalogue->at(tracer_name(side.setting))
                        .make(stages_.at(side.setting.form).scene, side.setting.params);
                const std::vector<Stat> stats = tracer->stats();
                samples[i].push_back(stat_value(stats, "build_ms") + stat_value(stats, "pack_ms"));
            }
        }
        return samples;
    }

    /// Baseline: what a plain copy of its state moves in a second. Variants: what their fetches ask
    /// for in a second of casting.
    Samples bandwidths() const {
        Samples samples(sides_.size() + 1);
        std::vector<RayBatch> batches(sides_.size());
        std::vector<double> bytes(sides_.size());
        for (size_t i = 1; i < sides_.size(); ++i) {
            if (!sides_[i].tracer) continue;
            Tracer& tracer = *sides_[i].tracer;
            batches[i] = tracer.upload(rays_.rays);
            bytes[i] = fetched_bytes(
                tracer.cast(batches[i], {.query = rays_.query, .counters = true}).counters,
                stat_value(tracer.stats(), "address_bits"));
        }
        const FrameRequest request = frame_request();
        Random random(workshop_.timing.seed);
        std::vector<size_t> order(samples.size());
        for (uint32_t round = 0; round < workshop_.timing.repetitions; ++round) {
            if (!go_on(progress_, 0.5)) break;
            std::iota(order.begin(), order.end(), size_t{0});
            random.shuffle(std::span(order));
            for (const size_t i : order) {
                const bool is_copy = i == 0 || i == sides_.size();
                Tracer* const tracer = sides_[is_copy ? 0 : i].tracer.get();
                if (!tracer) continue;
                samples[i].push_back(is_copy ? copy_bandwidth(*tracer, request)
                                             : bytes[i] / kGiB /
                                                   (1e-3 * tracer->cast(batches[i]).wall_ms));
            }
        }
        return samples;
    }

    static double copy_bandwidth(Tracer& tracer, FrameRequest request) {
        request.settings.aovs = false;
        const Frame frame = tracer.render(request.camera, request.settings);
        const double bytes = stat_value(frame.costs, "state_bytes_read") +
                             stat_value(frame.costs, "state_bytes_written");
        return bytes / kGiB / (1e-3 * stat_value(frame.costs, "copy_ms"));
    }

    // ---- Animations.

    void animate() {
        std::vector<std::vector<Affine>> poses;
        try {
            poses = workshop_.poses(*stages_.at(SceneForm::as_is).scene, workshop_.frames);
        } catch (const Error& error) {
            sides_.front().failure = error.what();
            return;
        }
        for (Side& side : sides_) {
            try {
                if (side.tracer) side.tracer->update(poses.front());
            } catch (const Error& error) {
                side.tracer = nullptr;
                side.failure = error.what();
            }
        }
        if (!sides_.front().tracer) return;

        FrameRequest request = frame_request();
        request.poses = poses;
        std::vector<Tracer*> tracers;
        std::vector<size_t> record_of_side(sides_.size());
        for (size_t i = 0; i < sides_.size(); ++i) {
            if (!sides_[i].tracer) continue;
            if (i > 0 && same_setting(sides_[i].setting, sides_.front().setting)) continue;
            record_of_side[i] = tracers.size();
            tracers.push_back(sides_[i].tracer.get());
        }
        const size_t oracle = tracers.size() - 1;  // the last variant is Embree
        tracers.push_back(tracers.front());
        const auto records = time_frames(tracers, oracle, request, workshop_.timing, progress_);
        keep_frame_timings(records,
                           [&](const FrameTimingRecord& r) { return &r != &records.back(); });

        const auto update_samples = [](const FrameTimingRecord& record) {
            std::vector<double> sums = record.update_ms;
            for (size_t f = 0; f < sums.size(); ++f) sums[f] += record.upload_ms[f];
            return sums;
        };
        for (const Probe& probe : experiment_.probes) {
            for (size_t i = 1; i < sides_.size(); ++i) {
                ClaimMeasurement m = blank(probe, sides_[i]);
                m.baseline += ", tracing";
                m.variant += ", update and upload";
                if (!same_setting(sides_[i].setting, sides_.front().setting)) {
                    m.expectation = Expectation::none;  // the oracle's update stands beside it
                }
                if (m.failure.empty()) {
                    m.baseline_samples = records.front().wall_ms;
                    m.variant_samples = update_samples(records[record_of_side[i]]);
                    m.again_samples = records.back().wall_ms;
                }
                measurements.push_back(std::move(m));
            }
        }
    }

    template <class Wanted>
    void keep_frame_timings(const std::vector<FrameTimingRecord>& records, Wanted&& wanted) {
        size_t next = 0;
        for (const Side& side : sides_) {
            if (!side.tracer || next >= records.size()) continue;
            const FrameTimingRecord& record = records[next];
            if (record.tracer != side.tracer->name()) continue;
            ++next;
            if (!wanted(record)) continue;
            frame_timings.push_back(record);
            frame_timings.back().scene = experiment_.scene;
            frame_timings.back().setting = params_text(side.setting.params);
        }
    }

    // ---- Reading.

    void conclude() {
        if (measurements.empty()) {  // the baseline failed
            for (const Probe& probe : experiment_.probes) {
                for (size_t i = 1; i < sides_.size(); ++i) {
                    measurements.push_back(blank(probe, sides_[i]));
                }
            }
        }
        for (ClaimMeasurement& m : measurements) summarise(m, workshop_.timing.seed);
        refusals();
    }

    /// A variant that its own tracer refuses is an answer where being possible is the question.
    void refusals() {
        for (ClaimMeasurement& m : measurements) {
            if (m.expectation != Expectation::possible || m.failure.empty()) continue;
            const auto side = std::find_if(sides_.begin() + 1, sides_.end(), [&](const Side& s) {
                return label_of(s.setting) == m.variant;
            });
            if (sides_.front().failure.empty() && side->known) m.verdict = ClaimVerdict::fails;
        }
    }

    const Experiment& experiment_;
    const std::string& entry_;
    const Workshop& workshop_;
    const Progress& progress_;
    RaySet rays_;
    std::map<SceneForm, Stage> stages_;
    std::vector<Side> sides_;  ///< the baseline first
};

}  // namespace

uint32_t image_side(const Workshop& workshop, const Experiment& experiment) {
    const uint32_t grow = experiment.fixed_side ? 1 : workshop.grow;
    return std::max(kLeastSide, experiment.side * grow / workshop.shrink);
}

std::string params_text(const ParamValues& params) {
    std::string text;
    for (const auto& [name, value] : params) {
        text += fmt::format("{}{}={}", text.empty() ? "" : ", ", name, value);
    }
    return text;
}

std::string label_of(const Setting& setting) {
    std::string label = setting.tracer;
    if (label.ends_with("/*")) label.resize(label.size() - 2);
    if (!setting.params.empty()) label += fmt::format(" ({})", params_text(setting.params));
    if (setting.form == SceneForm::flattened) label += ", one flat grid";
    if (setting.form == SceneForm::unshared) label += ", nothing shared";
    return label;
}

bool run_claim(const Claim& claim, const std::string& entry, const Workshop& workshop,
               const Progress& progress, Results& results) {
    ClaimRecord record;
    record.id = claim.id;
    record.entry = entry;
    record.claim = claim.claim;
    record.source = claim.source;
    record.then = claim.then;
    record.rule = claim.rule;
    record.command = fmt::format("onepass reproduce --claim {} --entry {}", claim.id, entry);

    std::vector<FrameTimingRecord> frame_timings;
    const double total = static_cast<double>(claim.experiments.size());
    for (size_t i = 0; i < claim.experiments.size(); ++i) {
        const Progress part = [&](double done) {
            return go_on(progress, (static_cast<double>(i) + done) / total);
        };
        ExperimentRun run(claim.experiments[i], entry, workshop, part);
        if (!run.run()) return false;
        std::move(run.measurements.begin(), run.measurements.end(),
                  std::back_inserter(record.measurements));
        std::move(run.frame_timings.begin(), run.frame_timings.end(),
                  std::back_inserter(frame_timings));
    }
    record.verdict = verdict_of(record.measurements, claim.reading);
    record.now = finding_of(claim, record.measurements);
    results.claims.push_back(std::move(record));
    results.frame_timings.insert(results.frame_timings.end(), frame_timings.begin(),
                                 frame_timings.end());
    return true;
}

}  // namespace onepass
