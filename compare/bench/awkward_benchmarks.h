// What a ray that is none (NaN, infinity, no direction) costs beside one that is.
#pragma once

namespace onepass {

/// Registers awkward_rays/TRACER/KIND for the strategies that users run, as fragment and as compute
/// shaders. The counter `times_a_normal_ray` is to stay at kMostTimesANormalRay or below.
void register_awkward_benchmarks();

/// The bound of Embree's own `verify` program for its rays of NaN and infinity.
inline constexpr double kMostTimesANormalRay = 2.5;

}  // namespace onepass
