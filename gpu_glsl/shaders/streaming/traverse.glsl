// Kernel: walks both grids until the ray stands before a list of triangles, or is at its end.
//
// The paper's two levels of loops (strategies/paper.glsl, lib/paper/object_level.glsl) turned
// inside out: one loop that can stop after any cell and go on in a later pass, and that walks
// whichever of the two grids the ray is in by the same code. The order of a ray's steps, and so
// every rounding, is the single pass's.
#include "streaming/state.glsl"

// The walk, as begin_walk() made it anew, brought to where an earlier pass left it.
void resume_walk(INOUT(Walk) walk, vec3 voxel, vec3 next_ts, float t_start) {
    walk.voxel = voxel;
    walk.next_ts = next_ts;
    walk.t_start = t_start;
    walk.t_end = lesser(smallest(next_ts), walk.t_exit);
}

// Goes on with `ray`, whose best hit so far is at `hit_t`, for at most steps_per_pass cells.
void traverse(Ray ray, float hit_t, INOUT(Walks) s, INOUT(uint) control) {
    uint turn = kTurnTraverse;
    uint finished_turn = casting ? kTurnNone : kTurnShade;
    bool begins = (control & kBegins) != 0u;
    bool at_object = (control & kAtObject) != 0u;
    if (begins && !at_object) ++rays_cast;
    for (int n = 0; n < steps_per_pass && turn == kTurnTraverse;) {
        // The grid at hand, and the ray in its frame.
        vec3 org = ray.org;
        vec3 dir = ray.dir;
        float t_first = ray.tmin;
        float t_stop = ray.tmax;
        vec2 grid_address = top_grid_address();
        if (at_object) {
            Instance instance = fetch_instance(s.instance);
            count_record();
            org = object_origin(instance, ray);
            dir = object_direction(instance, ray);
            grid_address = instance.grid;
            if (clip_to_cell == 1) {
                t_first = s.top_t_start;
                t_stop = s.top_t_end;
            }
        }
        Grid grid = fetch_grid(grid_address);
        count_record();

        // The walk: begun, or resumed.
        Walk walk = begin_walk(grid, org, dir, t_first, t_stop);
        int steps_left = grid.step_budget;
        if (!begins) {
            steps_left = at_object ? s.steps_left : s.top_steps_left;
            resume_walk(walk, at_object ? s.voxel : s.top_voxel,
                        at_object ? s.next_ts : s.top_next_ts,
                        at_object ? s.t_start : s.top_t_start);
        }

        // Cell by cell, until the level or the turn changes.
        bool in_object = at_object;
        bool next_level = false;
        while (n < steps_per_pass && turn == kTurnTraverse && !next_level) {
            ++n;

            // Step to the next cell. The budgets are asked where the single pass's loops ask them:
            // on the top level before a step, below it after one.
            bool exhausted = !in_object && !begins && steps_left <= 0;
            bool ends = begins ? missed(walk, grid)
                               : hit_t <= walk.t_end || !next_voxel(grid, walk);
            if (!begins) --steps_left;
            if (in_object && !ends) exhausted = steps_left <= 0;
            ends = ends || exhausted;

            // Look into the cell.
            CellList list = s.list;
            if (!ends) list = list_of_cell(walk);
            begins = false;
            if (!in_object) {
                s.list = list;
                s.top_steps_left = steps_left;
                if (ends) turn = finished_turn;
            } else if (ends) {
                // Back to the top level, and past this instance.
                s.list.address = next_reference(s.list.address);
                --s.list.count;
                at_object = false;
            } else if (list.count > 0) {
                turn = kTurnIntersect;
            }

            // From the top level, or back on it, take the next instance: a turn of its merged loop
            // (figure 3).
            if (!at_object && turn == kTurnTraverse && s.list.count > 0) {
                if (s.top_steps_left <= 0) {
                    exhausted = true;
                    turn = finished_turn;
                } else {
                    --s.top_steps_left;
                    s.instance = fetch_reference(s.list.address);
                    at_object = true;
                    begins = true;
                }
            }
            if (exhausted) control |= kOutOfBudget;
            next_level = begins || at_object != in_object;
        }

        if (in_object) {
            s.voxel = walk.voxel;
            s.next_ts = walk.next_ts;
            s.t_start = walk.t_start;
            s.t_end = walk.t_end;
            s.steps_left = steps_left;
        } else {
            s.top_voxel = walk.voxel;
            s.top_next_ts = walk.next_ts;
            s.top_t_start = walk.t_start;
            s.top_t_end = walk.t_end;
        }
    }
    control = with_turn(control & ~(kBegins | kAtObject), turn) | (begins ? kBegins : 0u) |
              (at_object ? kAtObject : 0u);
}

void main() {
    bool has_ray = open_state();
    uint control = kTurnNone;
    if (has_ray) {
        control = load_control();
        Ray ray = load_ray(control);
        float hit_t = load_hit_t(control);
        Walks walks = unpack_walks(load_walks());
        reset_counters();
        grid_bytes = 0u;
        if (copy_only) {
            control |= touched(ray) | touched(vec4(hit_t));
        } else {
            traverse(ray, hit_t, walks, control);
        }
        store_walks(pack_walks(walks));
        store_work(uvec4(cells_visited, references_read, rays_cast, all_grid_bytes()));
        store_control(control);
    }
    close_state(has_ray, turn_of(control));
}
