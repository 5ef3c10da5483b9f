#include "lib/place.glsl"
#include "lib/broken.glsl"

layout(location = 0) out vec4 color;

void main() { color = vec4(broken(1.0)); }
