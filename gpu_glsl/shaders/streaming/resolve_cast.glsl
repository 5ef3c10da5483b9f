// Kernel: from the state of finished rays to their answers. Runs once, after all others.
#include "streaming/state.glsl"

void main() {
    if (!open_state()) return;
    uint control = load_control();
    uvec4 traverse_work = load_walk_work(control);
    uvec4 intersect_work = load_hit_work(control);
    store_answer(load_hit(control), (control & kOutOfBudget) != 0u ? kFlagExhausted : 0u,
                 uvec4(traverse_work.x, intersect_work.x, traverse_work.y + intersect_work.y,
                       traverse_work.z),
                 traverse_work.w + intersect_work.z);
}
