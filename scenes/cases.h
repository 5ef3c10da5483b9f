// Robustness settings that others publish for their tracers, as ladders: what they hold themselves
// to, we are held to as well, and every answer is judged.
#pragma once

#include <cstdint>
#include <vector>

#include "core/ladder.h"

namespace onepass {

/// Every ray of every rung truly hits: a miss is a crack.
///
/// embree-verify       sphere and plane of 200 x 200 about (148376, 1234, -223423), rays from
/// inside
///                     the sphere and from 3 in front of the plane; Embree's `verify` program lets
///                     2 of 100,000 miss
/// pbrt-watertight     closed meshes with displaced corners, random and corner-aimed rays from
///                     inside; pbrt asks for 100,000 of each without one miss
/// subdivided-square   a square divided at random into 4 to 65,536 triangles, as in the conformance
///                     tests of Vulkan's ray queries: not one miss
std::vector<Ladder> robustness_cases();

/// The square from -1/2 to 1/2 in the plane z = 0, facing +z, divided at random into exactly
/// `triangles` of them: corners are put into triangles and on edges, the neighbour of a divided
/// edge is divided with it, and so no T-junction arises.
///
/// All corners lie on a lattice of 2^-22, on which orientations are exact: no triangle is flipped
/// or flat. Sizes differ by orders of magnitude, and many triangles are slivers.
/// `triangles` is at least 2. The same seed gives the same square on every machine.
Object make_subdivided_square(uint32_t triangles, uint64_t seed);

}  // namespace onepass
