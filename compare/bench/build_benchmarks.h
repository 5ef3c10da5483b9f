// What is built before the first ray: grids (and what is packed from them), each against Embree.
#pragma once

namespace onepass {

/// Registers every build benchmark on every mesh, named BENCHMARK/MESH.
void register_build_benchmarks();

}  // namespace onepass
