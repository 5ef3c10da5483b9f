// Going down a tree of boxes: which leaf a ray meets next, nearer children first.
//
// Why no leaf is lost. The ray that the boxes see is `org + t dir` in floats; the true one is up to
// `blur` beside it on every axis. So the planes through which it enters a box are moved towards the
// ray by as much, and those through which it leaves away from it. All other roundings are relative
// to t: direction, inverse, difference and product make 4 half ulps at either end, for which the
// far end is moved by 2^-20. A box entered in vain costs a step, one missed would cost hits.
// After Ize, "Robust BVH Ray Traversal", 2013.
#pragma once
#include "lib/math.glsl"
#include "lib/ray.glsl"

struct BoxRay {
    vec3 org_enter;  // for the planes through which a box is entered ...
    vec3 org_leave;  // ... and left
    vec3 inverse;
    bvec3 is_backward;
};

// A component of 0 would divide to infinity, and 0 * infinity is no number. One that is 2^-66 of
// the largest moves the ray by nothing within the tree. Where even that is below the least float,
// infinities and NaN do come up; node tests let NaN lose, so that such an axis decides nothing.
float inverse_of(float d, float largest_component) {
    float least = 1.3552527156068805e-20 * largest_component;
    float kept = abs(d) < least ? (d < 0.0 ? -least : least) : d;
    return 1.0 / kept;
}

BoxRay box_ray(vec3 org, vec3 dir, float blur) {
    float size = largest(abs(dir));
    BoxRay ray;
    ray.inverse = vec3(inverse_of(dir.x, size), inverse_of(dir.y, size), inverse_of(dir.z, size));
    ray.is_backward =
        bvec3(ray.inverse.x < 0.0, ray.inverse.y < 0.0, ray.inverse.z < 0.0);
    vec3 shift = vec3(ray.is_backward.x ? -blur : blur, ray.is_backward.y ? -blur : blur,
                      ray.is_backward.z ? -blur : blur);
    ray.org_enter = org + shift;
    ray.org_leave = org - shift;
    return ray;
}

const float kMissed = -1.0;

// Where the ray enters the box within [t_first, t_last], t_first >= 0; kMissed if it does not.
float entry_of(vec3 lower, vec3 upper, BoxRay ray, float t_first, float t_last) {
    const float kRounding = 1.00000095367431640625;  // 1 + 2^-20
    vec3 near = vec3(ray.is_backward.x ? upper.x : lower.x, ray.is_backward.y ? upper.y : lower.y,
                     ray.is_backward.z ? upper.z : lower.z);
    vec3 far = vec3(ray.is_backward.x ? lower.x : upper.x, ray.is_backward.y ? lower.y : upper.y,
                    ray.is_backward.z ? lower.z : upper.z);
    vec3 t_near = (near - ray.org_enter) * ray.inverse;
    vec3 t_far = (far - ray.org_leave) * ray.inverse;
    float enter = greater(greater(greater(t_first, t_near.x), t_near.y), t_near.z);
    float leave = lesser(lesser(lesser(t_last, t_far.x), t_far.y), t_far.z);
    return enter <= leave * kRounding ? enter : kMissed;
}

// ---- The stack ---------------------------------------------------------------------------------

// Nodes put aside, and where the ray enters them; one stack for both levels, the object's above the
// top level's. A tree of depth d never puts aside more than d: core/bvh/bvh.h bounds both depths
// so that 64 entries suffice.
uint stack_reference[64];
float stack_enter[64];
int stack_size;

const uint kNoReference = 0xFFFFFFFFu;

bool is_leaf(uint reference) { return reference >= kBvhLeaf; }
int first_slot(uint leaf) { return int((leaf - kBvhLeaf) / kBvhSlot); }
int slot_count(uint leaf) { return int(leaf % kBvhSlot); }

// The nearest of what was put aside since the stack had `base` entries, and is not beyond `t_last`;
// kNoReference if there is nothing.
uint take_up(int base, float t_last) {
    uint reference = kNoReference;
    while (stack_size > base && reference == kNoReference) {
        --stack_size;
        if (stack_enter[stack_size] <= t_last) reference = stack_reference[stack_size];
    }
    return reference;
}

// From a node to one of its children, with the other put aside; kNoReference if the ray meets
// neither.
uint step_down(Node node, BoxRay ray, float t_first, float t_last) {
    float first = entry_of(node.first.lower, node.first.upper, ray, t_first, t_last);
    float second = entry_of(node.second.lower, node.second.upper, ray, t_first, t_last);
    if (first == kMissed) return second == kMissed ? kNoReference : node.second.reference;
    if (second == kMissed) return node.first.reference;
    bool is_first_nearer = first <= second;
    stack_reference[stack_size] = is_first_nearer ? node.second.reference : node.first.reference;
    stack_enter[stack_size] = is_first_nearer ? second : first;
    ++stack_size;
    return is_first_nearer ? node.first.reference : node.second.reference;
}
