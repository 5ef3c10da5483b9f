// Which triangle a ray hits first: floats find candidates while they walk, and doubles decide
// between them when the walk is over.
//
// Floats find out which triangle of an instance is hit first, but for some that are `open`: they
// cannot tell whether those are hit, or before that one. They wait: a nearer hit may settle the
// question. A third one would have no room; the walk then stops, and is taken up after the
// decision.
#pragma once
#include "lib/query.glsl"
#include "lib/triangle/decide.glsl"
#include "lib/triangle/rule_out.glsl"

// ---- In floats, while they walk ----------------------------------------------------------------

struct Candidates {
    uint found;    // the triangle that is hit first, but for those open; or kNoId
    uint open;     // one of which floats cannot tell whether it is hit before that one; or kNoId
    uint other;    // another one
    float behind;  // what is hit surely beyond this t is behind `found`; negative: ray answered
    bool is_full;  // a third one is open, and has no room ...
    uint full_at;  // ... at this place of the walk
};

Candidates candidates_before(float behind, uint found) {
    return Candidates(found, kNoId, kNoId, behind, false, 0u);
}

// Takes in a triangle that the ray may cross at a place of the walk, `is_new` if it is no candidate
// yet.
//
// A hit is sure only if floats know its t to half of kWidth, and counts as known to kWidth: one
// bound then says where what is behind it begins and, less twice that, where what is surely before
// it ends.
void take_in(uint listed, uint place, bool is_new, Crossing crossing, INOUT(Candidates) now) {
    const float kWidth = 6.103515625e-5;  // 2^-14, in sizes of the object
    bool is_hit = may_be_within(crossing, now.behind) && is_new;
    bool is_clear = crossing.is_sure && crossing.error <= 0.5 * kWidth &&
                    crossing.t + crossing.error < now.behind - 2.0 * kWidth &&
                    crossing.t - crossing.error > 0.0;
    if (is_hit && is_clear) {
        now.found = listed;
        now.behind = any_hit_suffices ? -1.0 : crossing.t + kWidth;
    }
    if (is_hit && !is_clear) {
        bool has_room = now.other == kNoId;
        now.full_at = has_room ? now.full_at : place;
        now.is_full = !has_room;
        now.other = has_room ? now.open : now.other;
        now.open = has_room ? listed : now.open;
    }
}

// ---- In doubles, after the walk ----------------------------------------------------------------

// The candidates in the order in which doubles are asked about them; kNoId: no more.
struct Queue {
    uint asked;
    uint next;
    uint last;
};

Queue queue_of(Candidates candidates) {
    bool is_found = candidates.found != kNoId;
    return Queue(is_found ? candidates.found : candidates.open,
                 is_found ? candidates.open : candidates.other,
                 is_found ? candidates.other : kNoId);
}

Queue without_first(Queue queue) { return Queue(queue.next, queue.last, kNoId); }

// The nearest hit so far. Its t is compared as it is here; equal ones go to the lower instance,
// then to the lower triangle, so that the order of visits cannot show.
struct Nearest {
    double t;
    Hit hit;
    uint listed;  // what the walk calls the triangle
};

Nearest no_nearest() { return Nearest(double(infinity()), no_hit(), kNoId); }

bool is_before(uint inst_id, uint prim_id, Hit other) {
    return inst_id < other.inst_id || (inst_id == other.inst_id && prim_id < other.prim_id);
}

// Makes a hit within the ray's interval the nearest, if it is; true if so. `t`: of the ray.
bool take_nearer(SharpHit sharp, double t, Ray ray, uint inst_id, uint prim_id, uint listed,
                 INOUT(Nearest) nearest) {
    bool is_taken = sharp.is_hit && t >= double(ray.tmin) && t <= double(ray.tmax) &&
                    (t < nearest.t ||
                     (t == nearest.t && is_before(inst_id, prim_id, nearest.hit)));
    if (is_taken) nearest = Nearest(t, Hit(float(t), sharp.u, sharp.v, prim_id, inst_id), listed);
    return is_taken;
}

// Whether what was found answers the ray, wherever the nearest hit may be.
bool is_enough(Nearest nearest) { return any_hit_suffices && is_hit(nearest.hit); }
