// The shaders' triangle test (lib/triangle/rule_out.glsl) as C++, on one record.
#pragma once

#include "gpu_glsl/pack/barycentric_planes.h"

namespace onepass::test {

/// What the test says, and the numbers it goes by.
struct RuleOut {
    /// By how much weights differ in sign, in doubts: ruled out above 1.
    float disagreement = 0.0f;
    bool may_cross = false;
    bool is_known = false;
    bool is_sure = false;
    float t = 0.0f;
    float error = 0.0f;
};

/// Coordinates from the centre of a box with edges of 2 `half_box`; the largest component of `dir`
/// is 1/2 to 1.
RuleOut rule_out(const uint32_t* record, PlanesForm form, const vec3& org, const vec3& dir,
                 const vec3& half_box);

}  // namespace onepass::test
