// An honest tracer for tests, and every way to make it dishonest: tries all triangles in double and
// rounds once.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/catalogue.h"
#include "core/error.h"
#include "cpu_ref/ray_spread.h"

namespace onepass::test {

/// What a test breaks.
struct Sabotage {
    float slack_before_tmin = 0.0f;  ///< t this much below tmin counts as well
    bool takes_any_ray = false;      ///< asks not whether the ray is one
    uint32_t threads = 1;            ///< as Capabilities has it
    std::function<bool(const Hit& hit)> drops = [](const Hit&) { return false; };
    /// Has the last word on every answer. The scene is the one that was traced.
    std::function<void(const Scene&, const Ray&, Hit&, uint32_t& flags)> spoils =
        [](const Scene&, const Ray&, Hit&, uint32_t&) {};
};

class BruteTracer final : public Tracer {
  public:
    BruteTracer(ScenePtr scene, Sabotage sabotage)
        : scene_(std::move(scene)), sabotage_(std::move(sabotage)) {
        for (uint32_t i = 0; i < scene_->instances.size(); ++i) {
            const Instance& instance = scene_->instances[i];
            const Object& object = scene_->objects[instance.object];
            const DAffine map(instance.world_from_object);
            for (uint32_t p = 0; p < object.triangles.size(); ++p) {
                Triangle& triangle = triangles_.emplace_back(Triangle{i, p, {}});
                for (int k = 0; k < 3; ++k) {
                    triangle.corners[k] =
                        transform_point(map, dvec3(object.positions[object.triangles[p][k]]));
                }
            }
        }
    }

    const std::string& name() const override { return name_; }
    Capabilities capabilities() const override {
        Capabilities capabilities;
        capabilities.threads = sabotage_.threads;
        return capabilities;
    }
    std::vector<Stat> stats() const override { return {}; }
    RayBatch upload(std::span<const Ray> rays) override {
        return {rays.size(), std::make_shared<std::vector<Ray>>(rays.begin(), rays.end())};
    }
    CastResult cast(const RayBatch& batch, const CastOptions&) override {
        CastResult result;
        for (const Ray& ray : *static_cast<const std::vector<Ray>*>(batch.resident.get())) {
            Hit hit;
            if (sabotage_.takes_any_ray || is_traceable(ray)) hit = closest(ray);
            result.flags.push_back(0);
            sabotage_.spoils(*scene_, ray, hit, result.flags.back());
            result.hits.push_back(hit);
        }
        return result;
    }
    UpdateTimes update(std::span<const Affine>) override { return {}; }
    Frame render(const Camera&, const RenderSettings&) override { return {}; }

  private:
    struct Triangle {
        uint32_t inst_id;
        uint32_t prim_id;
        dvec3 corners[3];
    };

    /// Moeller and Trumbore's test. Of equal t the first triangle wins.
    Hit closest(const Ray& ray) const {
        Hit best;
        double best_t = std::numeric_limits<double>::infinity();
        const double tmin = double{ray.tmin} - double{sabotage_.slack_before_tmin};
        for (const Triangle& triangle : triangles_) {
            const dvec3 e1 = triangle.corners[1] - triangle.corners[0];
            const dvec3 e2 = triangle.corners[2] - triangle.corners[0];
            const dvec3 p = glm::cross(dvec3(ray.dir), e2);
            const double det = glm::dot(e1, p);
            if (det == 0.0) continue;
            const dvec3 s = dvec3(ray.org) - triangle.corners[0];
            const dvec3 q = glm::cross(s, e1);
            const double u = glm::dot(s, p) / det;
            const double v = glm::dot(dvec3(ray.dir), q) / det;
            const double t = glm::dot(e2, q) / det;
            if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
            // The interval holds for the t that is returned.
            const auto rounded = static_cast<float>(t);
            if (double{rounded} < tmin || rounded > ray.tmax || t >= best_t) continue;
            const Hit hit{rounded, static_cast<float>(u), static_cast<float>(v), triangle.prim_id,
                          triangle.inst_id};
            if (sabotage_.drops(hit)) continue;
            best = hit;
            best_t = t;
        }
        return best;
    }

    std::string name_ = "brute";
    ScenePtr scene_;
    Sabotage sabotage_;
    std::vector<Triangle> triangles_;
};

inline CatalogueEntry brute_entry(const Sabotage& sabotage = {}) {
    CatalogueEntry entry;
    entry.info.name = "brute";
    entry.make = [sabotage](ScenePtr scene, const ParamValues&) {
        return std::make_unique<BruteTracer>(std::move(scene), sabotage);
    };
    return entry;
}

}  // namespace onepass::test
