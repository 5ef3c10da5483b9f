// Compute form, once a round, after its kernels: empties the queues that were consumed and makes
// the filled ones ready. One invocation.
#include "lib/dialect.glsl"
#include "shared/streaming_layout.h"

CONSTANT(bool, copy_only)

layout(local_size_x = 1) in;

layout(std430) buffer QueueHeads { QueueHead heads[]; };

uniform int parity;  // of the round that has run

void main() {
    for (int kernel = 0; kernel < kKernels; ++kernel) {
        int consumed = 2 * kernel + parity;
        int filled = 2 * kernel + 1 - parity;
        if (copy_only) {
            // Behind the heads there is room for the copy's.
            heads[kQueues + consumed] = heads[consumed];
            heads[kQueues + filled] = heads[filled];
            continue;
        }
        heads[consumed].count = 0u;
        heads[consumed].groups_x = 0u;
        uint count = heads[filled].count;
        heads[filled].groups_x = (count + kQueueGroupSize - 1u) / kQueueGroupSize;
        uint low = heads[filled].runs_low + count;
        if (low < count) ++heads[filled].runs_high;
        heads[filled].runs_low = low;
    }
}
