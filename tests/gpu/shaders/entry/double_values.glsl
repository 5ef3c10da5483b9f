// Doubles every value of a storage buffer, and adds a generated constant.
layout(local_size_x = 64) in;

struct Pair {
    vec4 value;
    uvec4 id;
};
layout(std430) buffer Pairs { Pair pairs[]; };

uniform uint pair_count;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= pair_count) return;
    pairs[index].value *= 2.0;
    pairs[index].id += uvec4(id_offset);
}
