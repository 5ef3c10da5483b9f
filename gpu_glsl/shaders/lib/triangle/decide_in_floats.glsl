// The same decision as lib/triangle/decide.glsl makes, in floats: what its doubles cost and what
// they are worth can then be measured. It loses hits at edges and swaps surfaces that lie close.
#pragma once
#include "lib/triangle/decide.glsl"

SharpHit blunt_hit(Sight sight, Triangle triangle) {
    float ax = dot3(sight.right, triangle.v0) - sight.origin.x;
    float ay = dot3(sight.up, triangle.v0) - sight.origin.y;
    float bx = dot3(sight.right, triangle.v1) - sight.origin.x;
    float by = dot3(sight.up, triangle.v1) - sight.origin.y;
    float cx = dot3(sight.right, triangle.v2) - sight.origin.x;
    float cy = dot3(sight.up, triangle.v2) - sight.origin.y;
    float w0 = cx * by - cy * bx;
    float w1 = ax * cy - ay * cx;
    float w2 = bx * ay - by * ax;
    float area = w0 + w1 + w2;
    bool is_outside = (w0 < 0.0 || w1 < 0.0 || w2 < 0.0) && (w0 > 0.0 || w1 > 0.0 || w2 > 0.0);
    if (is_outside || area == 0.0) return SharpHit(false, double(infinity()), 0.0, 0.0);

    float share = 1.0 / area;
    float at = dot3(sight.along, triangle.v0) - sight.origin.z;
    float bt = dot3(sight.along, triangle.v1) - sight.origin.z;
    float ct = dot3(sight.along, triangle.v2) - sight.origin.z;
    float t = (w0 * at + w1 * bt + w2 * ct) * share;
    return SharpHit(true, double(t), w1 * share, w2 * share);
}
