// A tracer and a judge whose answers a test writes down, so that what compares them can be tested
// without any tracing.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/judge.h"
#include "core/tracer.h"

namespace onepass {

/// Answers each ray by a function. Each cast takes `cast_ms` and adds the tracer's name to `log`.
class FakeTracer final : public Tracer {
  public:
    explicit FakeTracer(std::string name) : name_(std::move(name)) {}

    std::function<Hit(const Ray&)> answer = [](const Ray&) { return Hit{}; };
    std::function<uint32_t(const Ray&)> flag = [](const Ray&) { return 0u; };  ///< RayFlag bits
    double cast_ms = 1.0;
    std::function<double()> device_ms = [] {  ///< of each cast
        return std::numeric_limits<double>::quiet_NaN();
    };
    double frame_ms = 1.0;          ///< of each render, which adds the name to `log` as well
    std::vector<Stat> frame_costs;  ///< of each render
    vec3 color{0.0f};               ///< of every pixel
    std::vector<std::string>* log = nullptr;
    Capabilities abilities;
    std::vector<Stat> figures;
    UpdateTimes update_times;
    std::vector<Affine> moved;   ///< the transforms of the last update
    std::optional<RayWalk> way;  ///< of every ray
    std::vector<ivec3> cells;    ///< of every triangle
    RayCounters cost{.cells = 3, .tests = 2, .references = 4, .rays = 1};

    const std::string& name() const override { return name_; }
    Capabilities capabilities() const override { return abilities; }
    std::vector<Stat> stats() const override { return figures; }

    RayBatch upload(std::span<const Ray> rays) override {
        return {rays.size(), std::make_shared<std::vector<Ray>>(rays.begin(), rays.end())};
    }
    CastResult cast(const RayBatch& batch, const CastOptions& options) override {
        if (log) log->push_back(name_);
        CastResult result;
        for (const Ray& ray : *static_cast<const std::vector<Ray>*>(batch.resident.get())) {
            result.hits.push_back(answer(ray));
            result.flags.push_back(flag(ray));
            if (options.counters) result.counters.push_back(cost);
        }
        result.wall_ms = cast_ms;
        result.device_ms = device_ms();
        return result;
    }
    std::optional<RayWalk> walk(const Ray&) override { return way; }
    std::vector<ivec3> cells_of(uint32_t, uint32_t) override { return cells; }
    UpdateTimes update(std::span<const Affine> world_from_object) override {
        moved.assign(world_from_object.begin(), world_from_object.end());
        return update_times;
    }
    Frame render(const Camera&, const RenderSettings& settings) override {
        Frame frame;
        frame.width = settings.width;
        frame.height = settings.height;
        if (log) log->push_back(name_);
        frame.color.resize(size_t{frame.width} * frame.height, color);
        if (settings.aovs) frame.counters.resize(frame.color.size(), cost);
        frame.wall_ms = frame_ms;
        frame.device_ms = std::numeric_limits<double>::quiet_NaN();
        frame.costs = frame_costs;
        return frame;
    }

  private:
    std::string name_;
};

/// Judges each answer by a function.
class FakeJudge final : public Judge {
  public:
    explicit FakeJudge(std::function<Verdict(const Ray&, const Hit&)> verdict)
        : verdict_(std::move(verdict)) {}

    std::string_view name() const override { return "fake judge"; }
    std::vector<Verdict> judge(const Ray& ray, Query, std::span<const Hit> answers) const override {
        std::vector<Verdict> verdicts;
        for (const Hit& answer : answers) verdicts.push_back(verdict_(ray, answer));
        return verdicts;
    }
    RayTruth explain(const Ray&, std::span<const Hit>) const override { return truth; }

    RayTruth truth;  ///< about every ray

  private:
    std::function<Verdict(const Ray&, const Hit&)> verdict_;
};

}  // namespace onepass
