#include "compare/trials/common.h"

#include <cmath>

#include "core/error.h"
#include "core/random.h"

namespace onepass::trials {
namespace {

vec3 uniform_in_box(const Bounds& box, Random& random) {
    const float x = random.unit();
    const float y = random.unit();
    const float z = random.unit();
    return box.lower + box.extent() * vec3(x, y, z);
}

/// By rejection from the cube.
vec3 uniform_direction(Random& random) {
    for (;;) {
        const vec3 p = 2.0f * uniform_in_box({vec3(0.0f), vec3(1.0f)}, random) - vec3(1.0f);
        const float squared = glm::dot(p, p);
        if (squared > 0.01f && squared < 1.0f) return p / std::sqrt(squared);
    }
}

vec3 random_corner(const Scene& scene, Random& random) {
    const auto inst_id = static_cast<uint32_t>(random.below(scene.instances.size()));
    const Object& object = scene.objects[scene.instances[inst_id].object];
    const auto prim_id = static_cast<uint32_t>(random.below(object.triangles.size()));
    return vec3(world_corners(scene, inst_id, prim_id)[random.below(3)]);
}

}  // namespace

std::vector<Ray> rays_from_outside(const Scene& scene, size_t count, float distance,
                                   double at_corners, uint64_t seed) {
    const Bounds box = scene_bounds(scene);
    Random random(seed);
    std::vector<Ray> rays(count);
    for (Ray& ray : rays) {
        ray.org = box.centre() + uniform_direction(random) * (distance * box.diagonal());
        const bool corner = double{random.unit()} < at_corners;
        ray.dir = (corner ? random_corner(scene, random) : uniform_in_box(box, random)) - ray.org;
    }
    return rays;
}

std::array<dvec3, 3> world_corners(const Scene& scene, uint32_t inst_id, uint32_t prim_id) {
    const Instance& instance = scene.instances[inst_id];
    const Object& object = scene.objects[instance.object];
    const DAffine world_from_object(instance.world_from_object);
    std::array<dvec3, 3> corners;
    for (int k = 0; k < 3; ++k) {
        corners[static_cast<size_t>(k)] = transform_point(
            world_from_object, dvec3(object.positions[object.triangles[prim_id][k]]));
    }
    return corners;
}

dvec3 outward_normal(const Scene& scene, uint32_t inst_id, uint32_t prim_id) {
    const auto [a, b, c] = world_corners(scene, inst_id, prim_id);
    const bool mirrored = determinant(scene.instances[inst_id].world_from_object) < 0.0;
    return glm::cross(b - a, c - a) * (mirrored ? -1.0 : 1.0);
}

CastResult cast_closest(Tracer& tracer, const std::vector<Ray>& rays) {
    if (rays.empty()) return {};
    const RayBatch batch = tracer.upload(rays);
    CastResult result;
    try {
        result = tracer.cast(batch, {});
    } catch (const Error&) {
        throw GaveUp{};
    }
    ONEPASS_CHECK_EQ(result.hits.size(), rays.size());
    ONEPASS_CHECK_EQ(result.flags.size(), rays.size());
    return result;
}

JudgedCast cast_and_judge(Tracer& tracer, const Judge& judge, const std::vector<Ray>& rays) {
    JudgedCast judged{cast_closest(tracer, rays), std::vector<Verdict>(rays.size())};
    tbb::parallel_for(size_t{0}, rays.size(), [&](size_t i) {
        const std::span<const Hit> answer(&judged.cast.hits[i], 1);
        judged.verdicts[i] = judge.judge(rays[i], Query::closest, answer).front();
    });
    return judged;
}

void keep_first(RungRecord& record, size_t index, const Ray& ray, const Hit& answer,
                const Verdict& verdict) {
    if (record.worst) return;
    record.worst = WorstRay{index, ray, answer, true_hit(verdict), verdict};
}

LadderRecord empty_record(const TrialTitle& title) {
    return {.id = title.id,
            .title = title.title,
            .question = title.question,
            .knob = title.knob,
            .unit = title.unit,
            .log_axis = title.log_axis,
            .judge = {},
            .command = {},
            .rungs = {}};
}

}  // namespace onepass::trials
