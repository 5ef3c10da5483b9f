#include "tests/gpu/rule_out_text.h"

#include <cmath>
#include <limits>

#include <glm/glm.hpp>

namespace onepass::test {
namespace {

#define ONEPASS_TWIN
#define PRECISE
#define NEEDS(name) 1
#define IN(T) T
#define OUT(T) T&
#define INOUT(T) T&
#define CONSTANT(T, name) T name = false;

using namespace glm;  // NOLINT: GLSL's built-in functions
using vec3 = glm::vec3;
using vec4 = glm::vec4;
using uint = glm::uint;

struct Text {
#include "lib/triangle/rule_out.glsl"
};

}  // namespace

RuleOut rule_out(const uint32_t* record, PlanesForm form, const vec3& org, const vec3& dir,
                 const vec3& half_box) {
    Text text;
    text.has_fixed_planes = form == PlanesForm::fixed;
    const auto texel = [&](size_t i) {
        if (4 * i >= planes_words(form)) return uvec4(0u);
        return uvec4(record[4 * i], record[4 * i + 1], record[4 * i + 2], record[4 * i + 3]);
    };
    const Text::Planes planes{texel(0), texel(1), texel(2)};
    const Text::Sight sight = text.sight_from(org, dir, half_box);
    const Text::Weights weights = text.weights_of(planes, sight);
    const Text::Crossing crossing = text.crossing_of(planes, weights, sight);
    const float least = min(weights.u, min(weights.v, weights.w));
    const float most = max(weights.u, max(weights.v, weights.w));
    return {min(-least, most) / sight.doubt,
            text.may_cross(weights, sight),
            crossing.is_known,
            crossing.is_sure,
            crossing.t,
            crossing.error};
}

}  // namespace onepass::test
