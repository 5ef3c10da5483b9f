// What a frame of moving instances takes before it is traced, against Embree's re-commit of the
// same.
#pragma once

namespace onepass {

/// Registers the benchmarks of moving instances, named BENCHMARK/INSTANCES: `top_level_rebuild` is
/// all that a tracer's update() does but for the upload to a GPU, `top_level_grid` the grid alone,
/// from boxes that are there.
void register_moving_benchmarks();

}  // namespace onepass
