// Which of the triangles met on the way is hit first, when rounding leaves that open.
//
// A walk knows every t only to within bounds, and of some triangles not even whether they are hit.
// It lowers `bound`, which the nearest hit's t does not exceed, and keeps the triangles that may be
// below it: mostly one, two where surfaces touch or the ray passes close to an edge. After the walk
// they are compared with twice the digits (lib/grid/sharp.glsl). Where there are more than two, the
// walk is repeated for those left out. So the answer is the same in whatever order triangles are
// met.
#pragma once
#include "lib/grid/sharp.glsl"

// A triangle that may be hit first.
struct Rival {
    Pair from;     // its t is at least this
    uint inst_id;  // kNoId: there is none
    uint prim_id;
};

struct Contest {
    Pair bound;      // t of the nearest hit is at most this; normalised
    Rival first;     // in the order of ids: lower instance, then lower triangle
    Rival second;
    Rival left_out;  // of those that found no room, the lowest ids and the least `from`
    uint next_inst;  // those of lower ids have been settled
    uint next_prim;
};

Rival nobody() { return Rival(Pair(infinity(), 0.0), kNoId, kNoId); }

bool are_before(uint inst_a, uint prim_a, uint inst_b, uint prim_b) {
    return inst_a < inst_b || (inst_a == inst_b && prim_a < prim_b);
}

Contest open_contest() {
    return Contest(Pair(infinity(), 0.0), nobody(), nobody(), nobody(), 0u, 0u);
}

// Nobody was left out who may be hit before the bound.
bool is_decided(Contest contest) {
    return contest.left_out.inst_id == kNoId || is_less(contest.bound, contest.left_out.from);
}

// Another round, for those that the last one left out; `t` of the nearest hit so far.
void reopen(INOUT(Contest) contest, Pair t) {
    if (is_less(t, contest.bound)) contest.bound = t;
    contest.next_inst = contest.left_out.inst_id;
    contest.next_prim = contest.left_out.prim_id;
    contest.first = nobody();
    contest.second = nobody();
    contest.left_out = nobody();
}

// The bound as a t from `start` on: a walk may end there.
float bound_from(Contest contest, float start) {
    return (contest.bound.hi - start) + contest.bound.lo;
}

void lower_bound(INOUT(Contest) contest, Pair bound) {
    if (!is_less(bound, contest.bound)) return;
    contest.bound = bound;
    if (is_less(bound, contest.second.from)) contest.second = nobody();
    if (is_less(bound, contest.first.from)) {
        contest.first = contest.second;
        contest.second = nobody();
    }
}

bool is_same(Rival a, Rival b) { return a.inst_id == b.inst_id && a.prim_id == b.prim_id; }
bool is_before(Rival a, Rival b) {
    return are_before(a.inst_id, a.prim_id, b.inst_id, b.prim_id);
}

void add_rival(INOUT(Contest) contest, Rival rival) {
    if (are_before(rival.inst_id, rival.prim_id, contest.next_inst, contest.next_prim)) return;
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
    if (is_before(rival, contest.left_out)) {
        contest.left_out.inst_id = rival.inst_id;
        contest.left_out.prim_id = rival.prim_id;
    }
    if (is_less(rival.from, contest.left_out.from)) contest.left_out.from = rival.from;
}

// A triangle that may be hit in `crossing`, seen from `start` on.
void enter(INOUT(Contest) contest, uint inst_id, uint prim_id, float start, Crossing crossing,
           Ray ray) {
    Pair from = two_sum(start, crossing.from);
    Pair to = two_sum(start, crossing.to);
    if (is_less(contest.bound, from) || !(from.hi <= ray.tmax) || !(to.hi >= ray.tmin)) return;
    if (crossing.is_sure && from.hi > ray.tmin && to.hi < ray.tmax) lower_bound(contest, to);
    add_rival(contest, Rival(from, inst_id, prim_id));
}

// The nearest hit of the rounds so far.
struct Winner {
    Hit hit;
    Pair t;  // of which hit.t is the rounding
};

// Ties at an equal t go to the lower instance, then to the lower triangle.
void settle(Contest contest, Ray ray, INOUT(Winner) winner) {
    int count = contest.second.inst_id != kNoId ? 2 : (contest.first.inst_id != kNoId ? 1 : 0);
    for (int k = 0; k < count; ++k) {
        uint inst_id = k == 0 ? contest.first.inst_id : contest.second.inst_id;
        uint prim_id = k == 0 ? contest.first.prim_id : contest.second.prim_id;
        SharpHit sharp = sharp_hit(ray, inst_id, prim_id);
        bool is_inside = sharp.is_hit && !is_less(sharp.t, Pair(ray.tmin, 0.0)) &&
                         !is_less(Pair(ray.tmax, 0.0), sharp.t);
        bool is_nearer = is_less(sharp.t, winner.t) ||
                         (!is_less(winner.t, sharp.t) &&
                          are_before(inst_id, prim_id, winner.hit.inst_id, winner.hit.prim_id));
        if (is_inside && is_nearer) {
            winner = Winner(Hit(sharp.t.hi, sharp.u, sharp.v, prim_id, inst_id), sharp.t);
            NOTE_HIT(winner.hit);
        }
    }
}
