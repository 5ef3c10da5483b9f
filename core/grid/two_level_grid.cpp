// The two levels, built independently of each other.
#include "core/grid/two_level_grid.h"

#include <chrono>

#include <tbb/parallel_for.h>

namespace onepass {

TwoLevelGrid build_two_level_grid(const Scene& scene, const TwoLevelSizing& sizing,
                                  Duplicates duplicates) {
    const auto start = std::chrono::steady_clock::now();
    check_object_count(sizing, scene.objects.size());
    TwoLevelGrid grid;
    grid.objects.resize(scene.objects.size());
    tbb::parallel_for(size_t{0}, scene.objects.size(), [&](size_t k) {
        grid.objects[k] = build_triangle_grid(scene.objects[k], sizing.of_object(k), duplicates);
    });
    grid.top = build_box_grid(instance_bounds(scene), sizing.top);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    grid.build_ms = elapsed.count();
    return grid;
}

}  // namespace onepass
