// Rounding errors of single operations, as numbers: what decides when rounded results cannot.
//
// Needs IEEE arithmetic that the compiler does not rearrange: every result is PRECISE.
#pragma once
#include "lib/bits.glsl"
#include "lib/dialect.glsl"

// hi + lo, together twice as long as one number.
struct Pair {
    float hi;
    float lo;
};

// a + b without rounding (Knuth).
Pair two_sum(float a, float b) {
    PRECISE float sum = a + b;
    PRECISE float b_part = sum - a;
    PRECISE float a_part = sum - b_part;
    PRECISE float error = (a - a_part) + (b - b_part);
    return Pair(sum, error);
}

// The leading half of a number's digits (Veltkamp).
float leading_half(float a) {
    PRECISE float scaled = splitter() * a;
    PRECISE float rest = scaled - a;
    PRECISE float leading = scaled - rest;
    return leading;
}

// a * b - product, where `product` is a * b rounded (Dekker).
float product_error(float a, float b, float product) {
    float a_hi = leading_half(a);
    float b_hi = leading_half(b);
    PRECISE float a_lo = a - a_hi;
    PRECISE float b_lo = b - b_hi;
    PRECISE float error =
        ((a_hi * b_hi - product) + a_hi * b_lo + a_lo * b_hi) + a_lo * b_lo;
    return error;
}

// a b - c d with the right sign: 0 only if the products are equal.
//
// Rounding keeps order, so a difference of rounded products is never of the wrong sign, but it may
// be 0 where the products are not equal; then what rounding took away from each decides.
float difference_of_products(float a, float b, float c, float d) {
    PRECISE float ab = a * b;
    PRECISE float cd = c * d;
    PRECISE float difference = ab - cd;
    if (difference == 0.0) difference = product_error(a, b, ab) - product_error(c, d, cd);
    return difference;
}

// sum + (a_hi + a_lo) * b, rounded in the last digits of the pair only.
Pair add_product(Pair sum, float a_hi, float a_lo, float b) {
    PRECISE float product = a_hi * b;
    Pair added = two_sum(sum.hi, product);
    PRECISE float lo = sum.lo + (added.lo + (product_error(a_hi, b, product) + a_lo * b));
    return Pair(added.hi, lo);
}
