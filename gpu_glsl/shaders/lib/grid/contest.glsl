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
    return (contest.bound.hi - start) + contest.bound.lo;
}

// A triangle that may be hit in `crossing`, seen from `start` on.
void enter(INOUT(Contest) contest, Rival rival, float start, Crossing crossing, Ray ray) {
    Pair from = two_sum(start, crossing.from);
    Pair to = two_sum(start, crossing.to);
    bool may_win = !is_less(contest.bound, from) && from.hi <= ray.tmax && to.hi >= ray.tmin;
    if (!may_win || is_before(rival, contest.next)) return;
    if (is_same(rival, contest.first) || is_same(rival, contest.second)) return;

    bool is_sure = crossing.is_sure && from.hi > ray.tmin && to.hi < ray.tmax;
    if (is_sure && is_less(to, contest.bound)) contest.bound = to;
    if (is_sure && is_less(to, contest.from)) {
        // Hit before all others can be.
        contest.from = from;
        contest.first = rival;
        contest.second = nobody();
        contest.left_out = nobody();
        return;
    }
    if (is_less(from, contest.from)) contest.from = from;
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
