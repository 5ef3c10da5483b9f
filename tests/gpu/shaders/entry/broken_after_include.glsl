#include "lib/place.glsl"

layout(location = 0) out vec4 color;

void main() {
    color = vec3(1.0);
}
