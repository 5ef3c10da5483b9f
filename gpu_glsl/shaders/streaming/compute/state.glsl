// Compute form: the state in buffers, in place, and rays in queues, two for each kernel.
//
// A pass runs one kernel over the rays in its queue, and each of them then joins the queue of the
// kernel whose turn is next. Those are other queues, consumed in the next round; so the kernels of
// a round touch different rays and need no order among themselves. A ray's place in a queue depends
// on chance, its answer does not: no kernel looks at another ray.
//
// Texel k of ray i has index i + k * ray_count, so that neighbours read neighbours. A kernel
// includes only the files whose buffers it uses: OpenGL promises no more than eight.
#pragma once
#include "streaming/state.glsl"

layout(local_size_x = 64) in;  // kQueueGroupSize

layout(std430) buffer ControlBuffer { uint control_words[]; };

layout(std430) buffer QueueHeads { QueueHead heads[]; };
layout(std430) buffer QueueBuffer { uint queued_rays[]; };

CONSTANT(bool, over_all_rays)  // generate and resolve: no queue is consumed
uniform int ray_count;
uniform int image_width;
uniform int first_row;  // of the image: what ray 0 belongs to
uniform int kernel;     // whose queue is consumed
uniform int parity;     // of the round

int ray_index;

int all_invocations() { return int(gl_GlobalInvocationID.x); }

bool open_state() {
    int place = all_invocations();
    ray_index = place;
    if (over_all_rays) return place < ray_count;
    int queue = 2 * kernel + parity;
    if (place >= int(heads[queue].count)) return false;
    ray_index = int(queued_rays[queue * ray_count + place]);
    return true;
}

// Joins the next queue: one atomic operation a work group and queue.
shared uint joining[kKernels];
shared uint first_place[kKernels];

void close_state(bool has_ray, uint turn) {
    if (copy_only) {
        // Behind the queues there is room for the copy's.
        if (has_ray) queued_rays[kQueues * ray_count + all_invocations()] = uint(ray_index);
        return;
    }
    uint local = gl_LocalInvocationIndex;
    if (local < uint(kKernels)) joining[local] = 0u;
    barrier();
    bool goes_on = has_ray && turn != kTurnNone;
    uint place = 0u;
    if (goes_on) place = atomicAdd(joining[turn], 1u);
    barrier();
    // Generate fills the queues of round 0.
    int filled_parity = over_all_rays ? 0 : 1 - parity;
    if (local < uint(kKernels) && joining[local] > 0u) {
        first_place[local] = atomicAdd(heads[2 * int(local) + filled_parity].count, joining[local]);
    }
    barrier();
    if (goes_on) {
        int queue = 2 * int(turn) + filled_parity;
        queued_rays[queue * ray_count + int(first_place[turn] + place)] = uint(ray_index);
    }
}

ivec2 pixel_of_ray() { return ivec2(ray_index % image_width, first_row + ray_index / image_width); }

uint load_control() { return control_words[ray_index]; }
void store_control(uint control) { control_words[ray_index] = control; }
