// The same decision as lib/triangle/decide.glsl makes, in floats: what its doubles cost and what
// they are worth can then be measured. It loses hits at edges and swaps surfaces that lie close.
#pragma once
#include "lib/triangle/decide.glsl"
#include "lib/triangle/rule_out.glsl"

// t from the sight's origin on.
SharpHit blunt_hit(Sight sight, Planes planes) {
    Weights weights = weights_of(planes, sight);
    float least = min(weights.u, min(weights.v, weights.w));
    float most = max(weights.u, max(weights.v, weights.w));
    float sum = weights.u + weights.v + weights.w;
    if ((least < 0.0 && most > 0.0) || weights.det == 0.0 || sum == 0.0) {
        return SharpHit(false, double(infinity()), 0.0, 0.0);
    }
    return SharpHit(true, double(weights.dist / weights.det), weights.v / sum, weights.w / sum);
}
