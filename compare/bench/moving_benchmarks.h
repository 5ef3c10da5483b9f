// What a frame of moving instances takes before it is traced, against Embree's re-commit of the
// same.
#pragma once

namespace onepass {

/// Registers the benchmarks of moving instances, named BENCHMARK/INSTANCES: `top_level_rebuild` is
/// all that the update() of a tracer with textures does but for the upload to a GPU,
/// `top_level_rebuild_buffers` the same of one with buffers, `top_level_grid` the grid alone, from
/// boxes that are there.
void register_moving_benchmarks();

}  // namespace onepass
