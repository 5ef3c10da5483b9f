// Going down a tree of boxes: which leaf a ray meets next, nearer children first.
//
// Why no leaf is lost. Boxes are stored from the centre of the one around them all, as the course
// is (lib/course.glsl), and rounded outwards. With u = 2^-24 and `reach` the largest coordinate of
// box and ray: the ray's origin is off by u of itself, and by 2^-49 of its way there; a plane times
// the inverse, less the origin times the inverse, by 4 u of reach times the inverse. So the planes
// through which the ray enters a box are moved towards it by `blur`, which is more, and those
// through which it leaves away from it. All other roundings are relative to t: direction, inverse
// (which a GPU may have wrong by 2.5 ulps) and difference make 7 u at either end, for which the far
// end is moved by 2^-20. A box entered in vain costs a step, one missed would cost hits. After Ize,
// "Robust BVH Ray Traversal", 2013.
#pragma once
#include "lib/course.glsl"

// The ray as boxes see it: it meets the plane x = p at t = p inverse.x - enter.x, or leave.x.
struct BoxRay {
    vec3 inverse;  // of its direction; finite
    vec3 enter;    // for the planes through which a box is entered ...
    vec3 leave;    // ... and left
    bvec3 is_backward;
};

// `around`: the box around all others.
BoxRay box_ray(Course course, Box around) {
    const float kLostByRounding = 4.76837158203125e-7;   // 2^-21: 8 u
    const float kLostByMoving = 1.7763568394002505e-15;  // 2^-49: 16 half ulps of a double
    vec3 farthest = greater(-around.lower, around.upper);
    float reach = largest(greater(abs(course.org), farthest));
    float way = float(double(course.start) * course.length_of_t);
    float blur = kLostByRounding * reach + kLostByMoving * (reach + way);
    BoxRay ray;
    ray.inverse = 1.0 / course.dir;
    ray.enter = course.org * ray.inverse + blur * abs(ray.inverse);
    ray.leave = course.org * ray.inverse - blur * abs(ray.inverse);
    ray.is_backward = bvec3(course.dir.x < 0.0, course.dir.y < 0.0, course.dir.z < 0.0);
    return ray;
}

// Where the ray enters a child's box within [0, t_last]; infinity() if it does not.
float entry_of(Child child, BoxRay ray, float t_last) {
    const float kRounding = 1.00000095367431640625;  // 1 + 2^-20
    vec3 near = mix(child.lower, child.upper, ray.is_backward) * ray.inverse - ray.enter;
    vec3 far = mix(child.upper, child.lower, ray.is_backward) * ray.inverse - ray.leave;
    float enter = max(max(near.x, near.y), max(near.z, 0.0));
    float leave = min(min(far.x, far.y), min(far.z, t_last));
    return mix(infinity(), enter, enter <= leave * kRounding);
}

// ---- The stack ---------------------------------------------------------------------------------

// Nodes put aside, and where the ray enters them: one that is behind by now is passed over and not
// fetched. One stack for both levels, the object's above the top level's. A walk of a tree of depth
// d never puts aside more than d, and below them kBvhNothing, which ends it: core/bvh/bvh.h bounds
// both depths (pack/bvh_buffers.cpp checks their sum).
uint stack_reference[BVH_STACK_ENTRIES];
float stack_enter[BVH_STACK_ENTRIES];
int stack_size;

bool is_inner(uint reference) { return reference >= kBvhInner; }
uint node_index(uint inner) { return inner - kBvhInner; }
int first_slot(uint leaf) { return int(leaf / kBvhSlot); }
uint slot_count(uint leaf) { return leaf % kBvhSlot; }
// A leaf but for its first slot.
uint without_first_slot(uint leaf) { return leaf + (kBvhSlot - 1u); }

void put_aside(uint reference, float enter) {
    stack_reference[stack_size] = reference;
    stack_enter[stack_size] = enter;
    ++stack_size;
}

// What a walk that begins now takes up in the end.
void put_end_aside() { put_aside(kBvhNothing, -infinity()); }

// The last put aside that is not beyond `t_last`.
uint take_up(float t_last) {
    do {
        --stack_size;
    } while (stack_enter[stack_size] > t_last);
    return stack_reference[stack_size];
}

// From a node to the child that the ray enters first, with the other put aside; from one that it
// does not meet to what was put aside.
uint step_down(Node node, BoxRay ray, float t_last) {
    float first = entry_of(node.first, ray, t_last);
    float second = entry_of(node.second, ray, t_last);
    bool is_first_nearer = first <= second;
    uint nearer = is_first_nearer ? node.first.reference : node.second.reference;
    uint farther = is_first_nearer ? node.second.reference : node.first.reference;
    if (max(first, second) < infinity()) put_aside(farther, max(first, second));
    if (!(min(first, second) < infinity())) nearer = take_up(t_last);
    return nearer;
}
