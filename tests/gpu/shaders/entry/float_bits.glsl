// The bits of three generated constants.
layout(local_size_x = 1) in;
layout(std430) buffer Bits { uint bits[]; };

void main() {
    bits[0] = floatBitsToUint(first);
    bits[1] = floatBitsToUint(second);
    bits[2] = floatBitsToUint(third);
}
