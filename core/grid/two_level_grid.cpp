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
    std::vector<Bounds> boxes(scene.objects.size());
    tbb::parallel_for(size_t{0}, scene.objects.size(), [&](size_t k) {
        const Object& object = scene.objects[k];
        boxes[k] = object_bounds(object);
        grid.objects[k] = build_triangle_grid(object, boxes[k], sizing.of_object(k), duplicates);
    });
    grid.instance_boxes = instance_bounds(scene, boxes);
    grid.top = build_box_grid(grid.instance_boxes, sizing.top);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    grid.build_ms = elapsed.count();
    return grid;
}

}  // namespace onepass
