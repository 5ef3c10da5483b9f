// Which of the triangles met on the way is hit first, when rounding leaves that open.
//
// A walk knows every t only to within bounds, and of some triangles not even whether they are hit.
// It lowers `bound`, which the nearest hit's t does not exceed, and keeps the triangles that may be
// below it: mostly one, two where surfaces touch or the ray passes close to an edge. After the walk
// these rivals are compared with twice the digits (lib/grid/sharp.glsl). Where there are more than
// two, the walk is repeated for those left out, from where the first of them can be: seen from
// there, errors are those of near things. So the answer is the same in whatever order triangles are
// met.
#pragma once
#include "lib/grid/sharp.glsl"

// Names a triangle. Order: lower instance, then lower triangle.
struct Rival {
    uint inst_id;  // kNoId: nobody, who comes after all others
    uint prim_id;
};

struct Contest {
    Pair bound;      // t of the nearest hit is at most this; normalised
    Pair from;       // t of every rival is at least this; normalised
    Rival first;     // in their order
    Rival second;
    Rival left_out;  // the first of those that found no room
    Rival next;      // those before it have been settled
    float start;     // the walk begins at this t: none that is not settled can be hit before
};

Rival nobody() { return Rival(kNoId, kNoId); }

bool is_before(Rival a, Rival b) {
    return a.inst_id < b.inst_id || (a.inst_id == b.inst_id && a.prim_id < b.prim_id);
}
bool is_same(Rival a, Rival b) { return a.inst_id == b.inst_id && a.prim_id == b.prim_id; }
bool is_somebody(Rival a) { return a.inst_id != kNoId; }

Contest open_contest(Ray ray) {
    Pair never = Pair(infinity(), 0.0);
    return Contest(never, never, nobody(), nobody(), nobody(), Rival(0u, 0u), ray.tmin);
}

// Another round, for those that the last one left out; `t` of the nearest hit so far.
void reopen(INOUT(Contest) contest, Pair t) {
    if (is_less(t, contest.bound)) contest.bound = t;
    const float kTwoUlps = 2.384185791015625e-7;
    contest.start = greater(contest.start, contest.from.hi - kTwoUlps * abs(contest.from.hi));
    contest.next = contest.left_out;
    contest.from = Pair(infinity(), 0.0);
    contest.first = nobody();
    contest.second = nobody();
    contest.left_out = nobody();
}

// The bound as a t from `start` on: a walk may end there.
float bound_from(Contest contest, float start) {
    const float kTwoUlps = 2.384185791015625e-7;
    float bound = (contest.bound.hi - start) + contest.bound.lo;
    return bound + kTwoUlps * abs(bound);
}

// ---- One instance ------------------------------------------------------------------------------

// The contest among the triangles of one instance, while it is walked through: every t is a float,
// from the walk's start on, and a rival is its number alone, kNoId if there is none.
struct Heat {
    float bound;     // as those of Contest
    float from;
    uint first;
    uint second;
    uint left_out;
    uint next;
    float t_first;   // the ray's interval, not shorter than it is ...
    float t_last;
    float t_inside;  // ... and not longer
    float t_before;
};

Heat open_heat(Contest contest, uint inst_id, float start, Ray ray) {
    const float kTwoUlps = 2.384185791015625e-7;
    float t_first = ray.tmin - start;
    float t_last = ray.tmax - start;
    float slack_first = kTwoUlps * abs(t_first);
    float slack_last = t_last < infinity() ? kTwoUlps * abs(t_last) : 0.0;
    uint next = inst_id == contest.next.inst_id ? contest.next.prim_id : 0u;
    return Heat(bound_from(contest, start), infinity(), kNoId, kNoId, kNoId, next,
                t_first - slack_first, t_last + slack_last, t_first + slack_first,
                t_last - slack_last);
}

uint lower_of(uint a, uint b) { return b < a ? b : a; }
uint higher_of(uint a, uint b) { return b < a ? a : b; }

// A triangle that may be hit in `crossing`.
void enter(INOUT(Heat) heat, uint prim_id, Crossing crossing) {
    if (crossing.from <= heat.bound && crossing.from <= heat.t_last &&
        crossing.to >= heat.t_first && prim_id >= heat.next) {
        bool is_sure =
            crossing.is_sure && crossing.from > heat.t_inside && crossing.to < heat.t_before;
        if (is_sure && crossing.to < heat.from) {
            // Hit before all others can be.
            heat.from = infinity();
            heat.first = kNoId;
            heat.second = kNoId;
            heat.left_out = kNoId;
        }
        if (is_sure) heat.bound = lesser(heat.bound, crossing.to);
        heat.from = lesser(heat.from, crossing.from);
        uint rival = prim_id == heat.first || prim_id == heat.second ? kNoId : prim_id;
        uint moved_on = higher_of(heat.first, rival);
        heat.first = lower_of(heat.first, rival);
        heat.left_out = lower_of(heat.left_out, higher_of(heat.second, moved_on));
        heat.second = lower_of(heat.second, moved_on);
    }
}

// ---- All instances -----------------------------------------------------------------------------

void add_rival(INOUT(Contest) contest, Rival rival) {
    if (is_same(rival, contest.first) || is_same(rival, contest.second)) return;
    if (is_before(rival, contest.first)) {
        Rival moved_on = contest.first;
        contest.first = rival;
        rival = moved_on;
    }
    if (is_before(rival, contest.second)) {
        Rival moved_on = contest.second;
        contest.second = rival;
        rival = moved_on;
    }
    if (is_before(rival, contest.left_out)) contest.left_out = rival;
}

// Takes over what came out of one instance.
void close_heat(Heat heat, uint inst_id, float start, INOUT(Contest) contest) {
    if (heat.first == kNoId) return;
    Pair from = two_sum(start, heat.from);
    Pair bound = two_sum(start, heat.bound);
    if (is_less(contest.bound, from)) return;
    if (is_less(bound, contest.bound)) contest.bound = bound;
    if (is_less(bound, contest.from)) {
        contest.from = from;
        contest.first = nobody();
        contest.second = nobody();
        contest.left_out = nobody();
    }
    if (is_less(from, contest.from)) contest.from = from;
    add_rival(contest, Rival(inst_id, heat.first));
    if (heat.second != kNoId) add_rival(contest, Rival(inst_id, heat.second));
    if (heat.left_out != kNoId) add_rival(contest, Rival(inst_id, heat.left_out));
}

// The nearest hit of the rounds so far.
struct Winner {
    Hit hit;
    Pair t;  // of which hit.t is the rounding
};

// Ties at an equal t go to the first.
void settle(Contest contest, Ray ray, INOUT(Winner) winner) {
    int count = is_somebody(contest.second) ? 2 : (is_somebody(contest.first) ? 1 : 0);
    for (int k = 0; k < count; ++k) {
        Rival rival = contest.first;
        if (k == 1) rival = contest.second;
        SharpHit sharp = sharp_hit(ray, rival.inst_id, rival.prim_id);
        bool is_hit = sharp.is_hit && !is_less(sharp.t, Pair(ray.tmin, 0.0)) &&
                      !is_less(Pair(ray.tmax, 0.0), sharp.t);
        // Rivals come in their order, in later rounds as well: an equal t is too late.
        if (is_hit && is_less(sharp.t, winner.t)) {
            winner.hit = Hit(sharp.t.hi, sharp.u, sharp.v, rival.prim_id, rival.inst_id);
            winner.t = sharp.t;
            NOTE_HIT(winner.hit);
        }
    }
}
