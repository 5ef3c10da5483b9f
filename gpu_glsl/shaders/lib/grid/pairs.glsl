// Two rays at once, for a software renderer.
//
// A CPU waits for most steps of a ray: the next one needs the end of the last. Two rays in one
// invocation do not wait for each other, so that one's steps fill the other's waits. What a ray
// does is what it does alone (strategies/grid.glsl), and so are its hits; only the loops are
// others, and turn as long as one of the two needs it.
//
// One thing a ray does not do here: to take a walk up again that stopped at a third open triangle.
// It would cost all rays, to keep what few of them need (some three of 10,000): those are cast once
// more, alone.
#pragma once
#include "strategies/grid.glsl"

// A ray on its way from walk to walk.
struct Search {
    Ray ray;
    Nearest nearest;
    bool goes_on;
    bool is_left;  // for a cast alone
    // The next walk: through an instance, where the ray is in [t_first, t_last].
    uint inst_id;
    float t_first;
    float t_last;
#if NEEDS(has_top_level)
    Descent descent;
#endif
};

// ---- From walk to walk -------------------------------------------------------------------------

#if NEEDS(has_top_level)
void aim_at_instance(INOUT(Search) search) {
    Span part = part_in_cell(search.descent);
    search.goes_on = search.descent.is_met;
    search.inst_id = search.goes_on ? search.descent.inst_id : kWholeScene;  // one that there is
    search.t_first = part.enter;
    search.t_last = part.leave;
    // (Neither an instance nor the end: the driver ended a loop.)
    search.is_left = search.is_left || !(search.descent.is_met || search.descent.is_over);
}

void begin_walks(INOUT(Search) search) {
    search.descent = begin_descent(search.ray, search.nearest.t);
    aim_at_instance(search);
}

void go_to_next_walk(INOUT(Search) search) {
    go_to_next_instance(search.nearest.t, search.descent);
    aim_at_instance(search);
}
#else
void begin_walks(INOUT(Search) search) { search.goes_on = true; }
void go_to_next_walk(INOUT(Search) search) { search.goes_on = false; }
#endif

Search begin_search(Ray ray) {
    Search search;
    search.ray = ray;
    search.nearest = no_nearest();
    search.goes_on = false;
    search.is_left = false;
    search.inst_id = kWholeScene;
    search.t_first = ray.tmin;
    search.t_last = ray.tmax;
    if (is_traceable(ray)) begin_walks(search);
    return search;
}

// After a walk and its decisions.
void go_on(Walker walker, INOUT(Search) search) {
    search.is_left = walker.candidates.is_full || !walker.is_over;
    search.goes_on = false;
    if (!search.is_left && !is_enough(search.nearest)) go_to_next_walk(search);
}

// ---- One walk of each --------------------------------------------------------------------------

Walker begin_walker(Search search) {
    Walker walker = begin_walker(search.inst_id, search.ray, search.t_first, search.t_last,
                                 search.nearest.t, listed_in(search.nearest, search.inst_id),
                                 no_findings());
    walker.is_over = walker.is_over || !search.goes_on;
    return walker;
}

bool is_before_empty_cells(Walker walker) { return !walker.is_over && is_in_empty_cell(walker); }

void begin_list(INOUT(Walker) walker) {
    enter_full_cell(walker);
    walker.next = fetch_triangle_reference(walker.at);
}

void test_list(INOUT(Walker) walker) {
    test_next_triangle(walker);
    ++walker.at;
}

void leave_list(INOUT(Walker) walker) {
    walker.is_over = walker.candidates.is_full || !is_before_end(walker);
    if (!walker.is_over) walker.cell = fetch_cell(walker.grid, walker.walk);
}

void walk_both(INOUT(Walker) a, INOUT(Walker) b) {
    if (!a.is_over || !b.is_over) {
        do {
            if (is_before_empty_cells(a) || is_before_empty_cells(b)) {
                do {
                    if (is_before_empty_cells(a)) cross_empty_cells(a);
                    if (is_before_empty_cells(b)) cross_empty_cells(b);
                } while (is_before_empty_cells(a) || is_before_empty_cells(b));
            }
            if (!a.is_over) begin_list(a);
            if (!b.is_over) begin_list(b);
            if (a.in_list || b.in_list) {
                do {
                    if (a.in_list) test_list(a);
                    if (b.in_list) test_list(b);
                } while (a.in_list || b.in_list);
            }
            if (!a.is_over) leave_list(a);
            if (!b.is_over) leave_list(b);
        } while (!a.is_over || !b.is_over);
    }
}

// What doubles are asked about is fetched for both before either is asked.
void decide_both(Walker walker_a, Walker walker_b, INOUT(Search) a, INOUT(Search) b) {
    Queue queue_a = queue_of(walker_a.candidates);
    Queue queue_b = queue_of(walker_b.candidates);
    bool asks_a = a.goes_on && queue_a.asked != kNoId;
    bool asks_b = b.goes_on && queue_b.asked != kNoId;
    if (asks_a || asks_b) {
        do {
            Asked asked_a = fetch_asked(walker_a.inst_id, asks_a ? queue_a.asked : 0u);
            Asked asked_b = fetch_asked(walker_b.inst_id, asks_b ? queue_b.asked : 0u);
            if (asks_a) decide_on(walker_a.inst_id, a.ray, walker_a.start, asked_a, a.nearest);
            if (asks_b) decide_on(walker_b.inst_id, b.ray, walker_b.start, asked_b, b.nearest);
            queue_a = without_first(queue_a);
            queue_b = without_first(queue_b);
            asks_a = asks_a && queue_a.asked != kNoId;
            asks_b = asks_b && queue_b.asked != kNoId;
        } while (asks_a || asks_b);
    }
}

// ---- The whole rays ----------------------------------------------------------------------------

// The answer to a given ray.
struct Answer {
    Hit hit;
    uint flags;
};

Answer answer_to(Search search) {
    ray_flags = is_cut(search.ray) ? kFlagExhausted : 0u;
    Hit hit = search.nearest.hit;
    if (search.is_left) hit = closest_hit(search.ray);
    return Answer(hit, ray_flags);
}

void closest_hits(Ray ray_a, Ray ray_b, OUT(Answer) answer_a, OUT(Answer) answer_b) {
    Search a = begin_search(ray_a);
    Search b = begin_search(ray_b);
    if (a.goes_on || b.goes_on) {
        do {
            Walker walker_a = begin_walker(a);
            Walker walker_b = begin_walker(b);
            walk_both(walker_a, walker_b);
            decide_both(walker_a, walker_b, a, b);
            if (a.goes_on) go_on(walker_a, a);
            if (b.goes_on) go_on(walker_b, b);
        } while (a.goes_on || b.goes_on);
    }
    answer_a = answer_to(a);
    answer_b = answer_to(b);
}
