// What is built before the first ray: grids (and what is packed from them), each against Embree.
#pragma once

namespace onepass {

/// Registers every build benchmark on every mesh, named BENCHMARK/MESH; those whose work depends on
/// the density BENCHMARK/density:D/MESH. `grid_memory` has no ratio to Embree but the counters
/// `bytes`, what building and packing take at their peak beside the scene, and `share_of_budget`,
/// that against 64 bytes a triangle, 16 a reference and 8 a cell; it is to be 1 or less.
void register_build_benchmarks();

}  // namespace onepass
