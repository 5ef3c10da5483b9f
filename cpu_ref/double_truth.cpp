// One crossing of a ray with a triangle in double, and the nearest ones among the candidates.
//
// Built with -ffp-contract=off: the edge functions of neighbours must round alike, which a fused
// multiply-add would spoil.
#include "cpu_ref/double_truth.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace onepass {

namespace {

/// A ray sheared so that it runs along +z from 0: the frame of the watertight test.
class Projection {
  public:
    Projection(const SpreadRay& ray, double position_tolerance)
        : org_(ray.org), tolerance_(position_tolerance) {
        const dvec3 size = glm::abs(ray.dir);
        z_ = size.x >= size.y && size.x >= size.z ? 0 : (size.y >= size.z ? 1 : 2);
        x_ = (z_ + 1) % 3;
        y_ = (z_ + 2) % 3;
        shear_x_ = ray.dir[x_] / ray.dir[z_];
        shear_y_ = ray.dir[y_] / ray.dir[z_];
        scale_z_ = 1.0 / ray.dir[z_];
    }

    std::optional<Crossing> cross(const WorldTriangle& triangle) const {
        // Corners in the ray's frame; z in units of t.
        std::array<dvec3, 3> p;
        for (int i = 0; i < 3; ++i) {
            const dvec3 relative = triangle[i] - org_;
            p[i] = {relative[x_] - shear_x_ * relative[z_], relative[y_] - shear_y_ * relative[z_],
                    scale_z_ * relative[z_]};
        }

        // Edge functions: a difference of two rounded products has the right sign or is 0. One is
        // the distance of the ray from the edge times the edge's length.
        dvec3 weight(p[2].x * p[1].y - p[2].y * p[1].x, p[0].x * p[2].y - p[0].y * p[2].x,
                     p[1].x * p[0].y - p[1].y * p[0].x);
        const double signed_area = weight.x + weight.y + weight.z;
        if (signed_area == 0.0) return {};
        if (signed_area < 0.0) weight = -weight;
        const dvec3 doubt =
            tolerance_ * dvec3(length(p[1], p[2]), length(p[2], p[0]), length(p[0], p[1]));
        if (weight.x < -doubt.x || weight.y < -doubt.y || weight.z < -doubt.z) return {};

        // t is a mean of the corners' t, so it lies between them even where a weight is in doubt.
        Crossing crossing;
        crossing.touch = weight.x < 0.0 || weight.y < 0.0 || weight.z < 0.0;
        weight = glm::max(weight, dvec3(0.0));
        const double area = weight.x + weight.y + weight.z;
        crossing.t = (weight.x * p[0].z + weight.y * p[1].z + weight.z * p[2].z) / area;
        const double span = std::max({p[0].z, p[1].z, p[2].z}) - std::min({p[0].z, p[1].z, p[2].z});
        const double slope_error = (doubt.x + doubt.y + doubt.z) / area;
        crossing.t_tolerance = tolerance_ * std::abs(scale_z_) + span * std::min(1.0, slope_error);
        return crossing;
    }

  private:
    static double length(const dvec3& a, const dvec3& b) {
        return std::max(std::abs(a.x - b.x), std::abs(a.y - b.y));
    }

    dvec3 org_;
    double tolerance_;
    int x_ = 0;
    int y_ = 0;
    int z_ = 0;
    double shear_x_ = 0.0;
    double shear_y_ = 0.0;
    double scale_z_ = 0.0;
};

}  // namespace

const Surface* Truth::find(uint32_t inst_id, uint32_t prim_id) const {
    for (const Surface& s : right) {
        if (s.inst_id == inst_id && s.prim_id == prim_id) return &s;
    }
    return nullptr;
}

WorldTriangle DoubleTruth::triangle(uint32_t inst_id, uint32_t prim_id) const {
    const Instance& instance = scene().instances[inst_id];
    const Object& object = scene().objects[instance.object];
    const uvec3 corners = object.triangles[prim_id];
    const DAffine world_from_object(instance.world_from_object);
    WorldTriangle result;
    for (int i = 0; i < 3; ++i) {
        result[i] = transform_point(world_from_object, dvec3(object.positions[corners[i]]));
    }
    return result;
}

// In object space, where differences of floats, and then products of differences, are exact or
// nearly so in double: 0 means no area, not rounding.
bool DoubleTruth::is_degenerate(uint32_t inst_id, uint32_t prim_id) const {
    const Object& object = scene().objects[scene().instances[inst_id].object];
    const uvec3 corners = object.triangles[prim_id];
    const dvec3 a(object.positions[corners.x]);
    const dvec3 b(object.positions[corners.y]);
    const dvec3 c(object.positions[corners.z]);
    return glm::cross(b - a, c - a) == dvec3(0.0);
}

double DoubleTruth::position_tolerance(const SpreadRay& ray) const {
    return kTieRoundings * 0x1p-53 * (candidates_.magnitude() + largest_component(ray.org));
}

std::optional<Crossing> DoubleTruth::crossing(const SpreadRay& ray, uint32_t inst_id,
                                              uint32_t prim_id) const {
    if (is_degenerate(inst_id, prim_id)) return {};
    return Projection(ray, position_tolerance(ray)).cross(triangle(inst_id, prim_id));
}

Truth DoubleTruth::find(const SpreadRay& ray) const {
    const Projection projection(ray, position_tolerance(ray));
    SpreadRay widened = ray;
    widened.org_reach = position_tolerance(ray);
    widened.dir_reach = 0.0;
    const double t_tolerance = position_tolerance(ray) / largest_component(ray.dir);
    widened.tmin -= t_tolerance;
    widened.tmax += t_tolerance;

    // Collect what is not behind the nearest surface inside the interval beyond doubt.
    std::vector<Surface> found;
    double firm_t = std::numeric_limits<double>::infinity();
    candidates_.visit(widened, [&](uint32_t inst_id, uint32_t prim_id) {
        const double farthest = std::min(widened.tmax, firm_t);
        const std::optional<Crossing> c = projection.cross(triangle(inst_id, prim_id));
        if (!c || is_degenerate(inst_id, prim_id)) return farthest;
        const double first = c->t - c->t_tolerance;
        const double last = c->t + c->t_tolerance;
        if (last < ray.tmin || first > std::min(ray.tmax, firm_t)) return farthest;
        const bool optional = c->touch || first <= ray.tmin || last >= ray.tmax;
        found.push_back({inst_id, prim_id, *c, optional});
        if (!optional) firm_t = std::min(firm_t, last);
        return std::min(farthest, firm_t);
    });

    // All of those that are still near enough, in the order of their ids.
    Truth truth;
    truth.miss_is_right = firm_t == std::numeric_limits<double>::infinity();
    const auto counts = [&](const Surface& s) {
        return !s.crossing.touch && s.crossing.t >= ray.tmin && s.crossing.t <= ray.tmax;
    };
    double nearest_t = std::numeric_limits<double>::infinity();
    for (const Surface& s : found) {
        if (s.crossing.t - s.crossing.t_tolerance > firm_t) continue;
        truth.right.push_back(s);
        if (counts(s)) nearest_t = std::min(nearest_t, s.crossing.t + s.crossing.t_tolerance);
    }
    std::sort(truth.right.begin(), truth.right.end(), [](const Surface& a, const Surface& b) {
        return std::tie(a.inst_id, a.prim_id) < std::tie(b.inst_id, b.prim_id);
    });
    for (const Surface& s : truth.right) {
        if (counts(s) && s.crossing.t - s.crossing.t_tolerance <= nearest_t) {
            truth.nearest = s;
            break;
        }
    }
    return truth;
}

}  // namespace onepass
