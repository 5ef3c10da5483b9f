// The meshes of the benchmarks, generated, so that a run needs no file.
#pragma once

#include <string>
#include <vector>

#include "core/scene.h"

namespace onepass {

struct BenchScene {
    std::string name;  ///< the triangle count, as it is written in a benchmark's name
    Scene scene;       ///< one object, one instance with the identity transform
};

/// A bumpy sphere at exactly 70,000 and at exactly 1,000,000 triangles.
std::vector<BenchScene> make_bench_scenes();

/// The same sphere at exactly 10,000,000 triangles. Takes seconds, and 180 MB.
Scene make_large_bench_scene();

}  // namespace onepass
