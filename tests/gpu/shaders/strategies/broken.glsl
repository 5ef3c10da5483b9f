// A strategy broken on purpose: the next reference of a list is looked for one row of the texture
// to the right, beyond its border. A GPU clamps the coordinate and goes on; the twin must not.
#define next_triangle_reference(address) (address + vec2(1.0, 0.0))
#include "strategies/paper.glsl"
#undef next_triangle_reference
