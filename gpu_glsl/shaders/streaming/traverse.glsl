// Kernel: walks both grids until the ray stands before a list of triangles, or is at its end.
//
// The paper's two loops (strategies/paper.glsl, lib/paper/object_level.glsl), turned inside out: a loop
// that can stop after any step and go on in a later pass. The order of steps, and so every rounding,
// is the single pass's.
#include "streaming/state.glsl"

// A ray within the grid of one instance's object.
struct ObjectWalk {
    Grid grid;
    Walk walk;
};

ObjectWalk begin_object_walk(vec2 address, Ray ray, float t_start, float t_stop) {
    Instance instance = fetch_instance(address);
    Grid grid = fetch_grid(instance.grid);
    count_record();
    count_record();
    return ObjectWalk(grid, begin_walk(grid, object_origin(instance, ray),
                                       object_direction(instance, ray), t_start, t_stop));
}

// The walk, as begin_walk() made it anew, brought to where an earlier pass left it.
void resume_walk(INOUT(Walk) walk, vec3 voxel, vec3 next_ts, float t_start) {
    walk.voxel = voxel;
    walk.next_ts = next_ts;
    walk.t_start = t_start;
    walk.t_end = lesser(smallest(next_ts), walk.t_exit);
}

// Goes on with `ray`, whose best hit so far is at `hit_t`, for at most steps_per_pass cells.
void traverse(Ray ray, float hit_t, INOUT(Walks) s, INOUT(uint) control) {
    // The top level: begin, or resume.
    Grid grid = fetch_grid(top_grid_address());
    count_record();
    Walk walk = begin_walk(grid, ray.org, ray.dir, ray.tmin, ray.tmax);
    bool at_object = (control & kAtObject) != 0u;
    bool resuming = at_object;
    if ((control & kNewRay) != 0u) {
        control &= ~kNewRay;
        ++rays_cast;
        if (missed(walk, grid)) {
            control = with_turn(control, kTurnShade);
            return;
        }
        s.list = list_of_cell(walk);
        s.top_steps = 0;
    } else {
        resume_walk(walk, s.top_voxel, s.top_next_ts, s.top_t_start);
    }

    uint turn = kTurnTraverse;
    for (int n = 0; n < steps_per_pass && turn == kTurnTraverse;) {
        // A turn of the merged top loop (figure 3): step, or take the next instance.
        if (!at_object) {
            ++n;
            if (s.top_steps >= grid.step_budget) {
                control |= kOutOfBudget;
                turn = kTurnShade;
                break;
            }
            ++s.top_steps;
            if (s.list.count == 0) {
                if (hit_t <= walk.t_end || !next_voxel(grid, walk)) {
                    turn = kTurnShade;
                } else {
                    s.list = list_of_cell(walk);
                }
                continue;
            }
        }

        // The object level, from its beginning or from the cell whose triangles have been tested.
        float t_first = clip_to_cell == 1 ? walk.t_start : ray.tmin;
        float t_last = clip_to_cell == 1 ? walk.t_end : ray.tmax;
        vec2 address = resuming ? fetch_reference_again(s.list.address)
                                : fetch_reference(s.list.address);
        ObjectWalk object = begin_object_walk(address, ray, t_first, t_last);
        bool leaves = false;
        if (resuming) {
            resume_walk(object.walk, s.voxel, s.next_ts, s.t_start);
        } else {
            s.steps = 0;
            leaves = missed(object.walk, object.grid);
        }
        bool stands_in_new_cell = !resuming;
        at_object = true;
        resuming = false;
        for (; at_object && turn == kTurnTraverse && (stands_in_new_cell || n < steps_per_pass);) {
            if (!stands_in_new_cell) {
                ++n;
                ++s.steps;
                leaves = hit_t <= object.walk.t_end || !next_voxel(object.grid, object.walk);
            }
            stands_in_new_cell = false;
            if (!leaves && s.steps >= object.grid.step_budget) {
                control |= kOutOfBudget;
                leaves = true;
            }
            if (leaves) {
                s.list.address = next_reference(s.list.address);
                --s.list.count;
                at_object = false;
            } else if (list_of_cell(object.walk).count > 0) {
                turn = kTurnIntersect;
            }
        }
        s.voxel = object.walk.voxel;
        s.next_ts = object.walk.next_ts;
        s.t_start = object.walk.t_start;
        s.t_end = object.walk.t_end;
    }

    s.top_voxel = walk.voxel;
    s.top_next_ts = walk.next_ts;
    s.top_t_start = walk.t_start;
    control = with_turn(at_object ? control | kAtObject : control & ~kAtObject, turn);
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
