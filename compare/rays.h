// Ray sets: what is cast, by kind, the same on every machine.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/scene.h"
#include "core/tracer.h"
#include "core/types.h"

namespace onepass {

/// Rays with their name and their content's hash.
struct RaySet {
    std::string name;  ///< the kind, or the file's name
    std::string hash;  ///< 16 hexadecimal digits
    Query query = Query::closest;
    std::vector<Ray> rays;
    bool at_edges = false;  ///< every ray is aimed at an edge or a corner: `edge` has no budget
    /// Where a ray kind belongs to an image: its size, and the pixel (x + width * y) of each ray.
    uint32_t width = 0;
    uint32_t height = 0;
    std::vector<uint32_t> pixels;
};

/// One built-in ray kind, for help texts and error messages.
struct RayKind {
    std::string name;
    std::string summary;
};

/// primary, scan, random, diffuse, shadow, reflection, vertex, edge.
const std::vector<RayKind>& ray_kinds();

/// How many rays, and from where.
struct RayRequest {
    uint32_t width = 512;   ///< pixels; random rays are width * height as well
    uint32_t height = 512;  ///< pixels
    uint32_t camera = 0;    ///< index into Scene::cameras
    uint64_t seed = 0;
};

/// Pixels in the order in which rays are cast: 8 x 4-pixel tiles, whose halves of 4 x 4 consist of
/// parts of 4 x 2 (`tiled`), or scan lines. What the image's border cuts off is smaller.
std::vector<uint32_t> pixel_order(uint32_t width, uint32_t height, bool tiled);

/// Pairs (a, b) of uniform points in the box: org = a, dir = b - a, tmin = 0, tmax = inf.
std::vector<Ray> random_rays(const Bounds& bounds, size_t count, uint64_t seed);

/// A unit vector about the unit vector `normal` with density proportional to the cosine, from two
/// numbers in the unit disk. Only +, *, / and sqrt, so that it rounds alike everywhere.
vec3 cosine_direction(const vec3& normal, float disk_x, float disk_y);

/// Makes a ray set by kind, or reads a file (a name that ends in .npy).
///
/// primary     through the pixels' centres, in 8 x 4-pixel tiles
/// scan        the same rays in scan lines
/// random      random_rays() in the scene's box
/// diffuse     one cosine-weighted bounce from each primary hit
/// shadow      from each primary hit to each light that its front faces; any-hit, t in [0, 1]
/// reflection  one mirror bounce from each primary hit, whatever its material
/// vertex      width * height rays from uniform points of the scene's box to the corners of uniform
///             triangles, instances drawn alike
/// edge        the same to uniform points of their edges
///
/// Secondary rays start at core/shading.h's offset, from hits that `oracle` finds.
/// Throws: Error for an unknown kind, a camera that is not there, a bad file, or a kind that yields
/// no ray in this scene.
RaySet make_ray_set(const std::string& kind_or_file, const Scene& scene, Tracer& oracle,
                    const RayRequest& request);

}  // namespace onepass
