// Kernel: tests the ray against the triangles of the cell in which traverse left it.
#include "streaming/state.glsl"

// Goes on with the cell's list for at most steps_per_pass triangles.
void intersect(Ray ray, Walks s, INOUT(HitState) state, INOUT(uint) control) {
    Instance instance = fetch_instance(s.instance);
    int first_triangle = fetch_grid(instance.grid).first_triangle;
    count_record();
    count_record();
    vec3 org = object_origin(instance, ray);
    vec3 dir = object_direction(instance, ray);
    float t_first = clip_to_cell == 1 ? s.t_start : ray.tmin;
    float t_last = clip_to_cell == 1 ? s.t_end : ray.tmax;

    // References lie side by side in rows of a power of two, so this product is next_reference()
    // applied `cursor` times, to the bit.
    CellList list = fetch_cell_again(s.voxel);
    list.address.x += float(state.cursor) / float(SIZE2D(references).x);
    for (int n = 0; n < steps_per_pass && state.cursor < list.count; ++n) {
        intersect_triangle(fetch_reference(list.address), org, dir, t_first, t_last,
                           instance.inst_id, first_triangle, state.hit);
        list.address = next_reference(list.address);
        ++state.cursor;
    }
    control |= kHasHitState;
    if (state.cursor >= list.count) {
        state.cursor = 0;
        control = with_turn(control, kTurnTraverse);
    }
}

void main() {
    bool has_ray = open_state();
    uint control = kTurnNone;
    if (has_ray) {
        control = load_control();
        Ray ray = load_ray(control);
        // What only traverse needs comes back as 0.
        vec4 e = load_walk_e(control);
        vec4 f = load_walk_f(control);
        vec4 none = vec4(0.0);
        Walks walks = unpack_walks(WalkTexels(none, none, none, none, e, f));
        HitState state = load_own_hit(control);
        reset_counters();
        grid_bytes = 0u;
        if (copy_only) {
            control |= touched(ray) | touched(e) | touched(f);
        } else {
            intersect(ray, walks, state, control);
        }
        store_hit(vec4(state.hit.t, state.hit.u, state.hit.v, float(state.cursor)),
                  uvec2(state.hit.prim_id, state.hit.inst_id));
        store_work(uvec4(triangle_tests, references_read, all_grid_bytes(), 0u));
        store_control(control);
    }
    close_state(has_ray, turn_of(control));
}
