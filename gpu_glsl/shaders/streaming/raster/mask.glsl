// Raster form, once a round: the depth buffer becomes the mask of the round's kernels.
//
// Each ray's depth says which kernel it waits for. A kernel's pass is drawn at that kernel's depth
// with the test "equal": the hardware drops all other fragments before their shader runs (early
// depth test), and an occlusion query counts the rest. The pass also copies the control words,
// because the kernels write them.
#include "shared/streaming_layout.h"

uniform usampler2D control_words;
uniform uint written_sides;  // of each kernel's own part: the bit is set if its pass writes side 1

layout(location = 0) out uint out_control;

void main() {
    uint control = texelFetch(control_words, ivec2(gl_FragCoord.xy), 0).x;
    out_control = control;
    uint turn = control & kTurnMask;
    bool lies_on_written_side = ((control ^ written_sides) & (kWalkSide << turn)) == 0u;
    if (lies_on_written_side) turn = kTurnNone;
    gl_FragDepth = kPassDepths * float(turn + 1u);
}
