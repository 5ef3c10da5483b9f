#include "compare/timing_trial.h"

#include <utility>
#include <vector>

namespace onepass {
namespace {

class SlowedTracer final : public Tracer {
  public:
    explicit SlowedTracer(std::unique_ptr<Tracer> tracer)
        : tracer_(std::move(tracer)), name_(tracer_->name() + ", slowed") {}

    const std::string& name() const override { return name_; }
    Capabilities capabilities() const override { return tracer_->capabilities(); }
    std::vector<Stat> stats() const override { return tracer_->stats(); }

    RayBatch upload(std::span<const Ray> rays) override {
        std::vector<Ray> more;
        more.reserve(rays.size() + rays.size() / kRepeatEvery + 1);
        for (size_t i = 0; i < rays.size(); ++i) {
            more.push_back(rays[i]);
            // Beside its twin, so that the order of casting stays what it is.
            if (i % kRepeatEvery == 0) more.push_back(rays[i]);
        }
        return tracer_->upload(more);
    }

    CastResult cast(const RayBatch& batch, const CastOptions& options) override {
        CastResult cast = tracer_->cast(batch, options);
        drop_repeated(cast.hits);
        drop_repeated(cast.flags);
        drop_repeated(cast.counters);
        return cast;
    }

    UpdateTimes update(std::span<const Affine> world_from_object) override {
        return tracer_->update(world_from_object);
    }
    Frame render(const Camera& camera, const RenderSettings& settings) override {
        return tracer_->render(camera, settings);
    }

  private:
    /// In a batch each group of a twentieth and one more begins with a pair.
    template <class T>
    static void drop_repeated(std::vector<T>& of_rays) {
        std::vector<T> kept;
        for (size_t i = 0; i < of_rays.size(); ++i) {
            if (i % (kRepeatEvery + 1) != 1) kept.push_back(of_rays[i]);
        }
        of_rays = std::move(kept);
    }

    std::unique_ptr<Tracer> tracer_;
    std::string name_;
};

uint32_t& tally(std::array<uint32_t, 4>& counts, SpeedVerdict verdict) {
    return counts[static_cast<size_t>(verdict)];
}

}  // namespace

std::unique_ptr<Tracer> slowed(std::unique_ptr<Tracer> tracer) {
    return std::make_unique<SlowedTracer>(std::move(tracer));
}

uint32_t TimingTrial::called_different() const {
    return of_equals[static_cast<size_t>(SpeedVerdict::faster)] +
           of_equals[static_cast<size_t>(SpeedVerdict::slower)];
}

uint32_t TimingTrial::found_slower() const {
    return of_slowed[static_cast<size_t>(SpeedVerdict::slower)];
}

bool passed(const TimingTrial& trial) {
    return trial.called_different() <= kMostCalledDifferent * trial.comparisons &&
           trial.found_slower() >= kLeastFoundSlower * trial.comparisons;
}

TimingTrial try_timing(const CatalogueEntry& entry, const ScenePtr& scene,
                       const ParamValues& params, const RaySet& rays,
                       const TimingTrialOptions& options, const Progress& progress) {
    const std::unique_ptr<Tracer> strategy = entry.make(scene, params);
    const std::unique_ptr<Tracer> rival = entry.make(scene, params);
    const std::unique_ptr<Tracer> equal = entry.make(scene, params);
    const std::unique_ptr<Tracer> slower = slowed(entry.make(scene, params));
    Tracer* const contestants[] = {strategy.get(), equal.get(), slower.get()};

    TimingTrial trial;
    TimingOptions timing = options.timing;
    timing.rival = Rival{0, rival.get()};
    for (uint32_t i = 0; i < options.comparisons; ++i) {
        timing.seed = options.timing.seed + i;
        const Progress part = [&](double done) {
            return go_on(progress, (i + done) / options.comparisons);
        };
        const std::vector<TimingRecord> records = time_casts(contestants, 0, rays, timing, part);
        if (records.front().wall_ms.size() < timing.repetitions) break;

        const TimingRecord* const with_rival[] = {&records[0]};
        const double noise =
            noise_of_case(with_rival, !records.front().device_ms.empty(), timing.seed);
        const SpeedComparison of_equal = compare_speeds(records[1], records[0], noise, timing.seed);
        const SpeedComparison of_slow = compare_speeds(records[2], records[0], noise, timing.seed);
        ++tally(trial.of_equals, of_equal.verdict);
        ++tally(trial.of_slowed, of_slow.verdict);
        trial.noise.push_back(noise);
        trial.equals_ratio.push_back(of_equal.speed.ratio);
        trial.slowed_ratio.push_back(of_slow.speed.ratio);
        ++trial.comparisons;
    }
    return trial;
}

}  // namespace onepass
