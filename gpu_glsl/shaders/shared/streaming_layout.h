// The state of a ray in flight: its control word, and how many texels each kernel owns of it. One
// text for C++ and GLSL.
#pragma once

// ---- The control word: what the ray waits for, and where its state lies ------------------------

const uint kTurnMask = 3u;  // the kernel whose turn it is
const uint kTurnTraverse = 0u;
const uint kTurnIntersect = 1u;
const uint kTurnShade = 2u;
const uint kTurnNone = 3u;      // the ray (of a frame: the pixel) has its answer
const uint kBegins = 4u;        // its walk through the grid at hand has not begun
const uint kHasHitState = 8u;   // the stored hit is this ray's; else it has none yet
const uint kAtObject = 16u;     // it walks the grid of an object
const uint kOutOfBudget = 32u;  // a walk ended by its budget: RayFlag exhausted
const uint kWalkSide = 64u;     // raster form: which of two textures holds what the kernel owns;
const uint kHitSide = 128u;     // kWalkSide << turn is the side of that kernel's own state
const uint kPathSide = 256u;

// Of a frame's ray: mirrors so far, and the light that a shadow ray goes to, plus one.
const int kDepthShift = 9;
const uint kDepthMask = 255u;
const int kLightShift = 17;
const uint kLightMask = 32767u;

// ---- What each kernel owns, in texels of four floats -------------------------------------------

const int kWalkTexels = 6;  // traverse
const int kHitTexels = 1;   // intersect; and a texel of two integers
const int kPathTexels = 6;  // shade; and a texel of four integers

// ---- Raster form: a kernel's pass is drawn at depth kPassDepths * (its turn + 1) ---------------

const float kPassDepths = 0.25;

// ---- Compute form: two queues a kernel, one being consumed and one being filled ----------------

const int kKernels = 3;
const int kQueues = 6;             // queue 2 * turn + parity of the round that consumes it
const uint kQueueGroupSize = 64u;  // rays of a work group

struct QueueHead {
    uint groups_x;  // the indirect dispatch that consumes the queue
    uint groups_y;
    uint groups_z;
    uint count;     // rays in the queue
    uint runs_low;  // rays that it has held in all rounds so far, in 64 bits
    uint runs_high;
    uint unused0;
    uint unused1;
};
