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

// ---- Arithmetic of pairs -----------------------------------------------------------------------
//
// Each result is wrong by a few units in the pair's last place, of the largest number that went in.

// sum + a b.
Pair add_product(Pair sum, Pair a, Pair b) {
    PRECISE float product = a.hi * b.hi;
    Pair added = two_sum(sum.hi, product);
    PRECISE float rest = product_error(a.hi, b.hi, product) + (a.hi * b.lo + a.lo * b.hi);
    PRECISE float lo = sum.lo + (added.lo + rest);
    return Pair(added.hi, lo);
}

// The same number with hi rounded to nearest: only then does order of hi, then lo, order numbers.
Pair normalised(Pair a) { return two_sum(a.hi, a.lo); }

Pair negated(Pair a) { return Pair(-a.hi, -a.lo); }

Pair pair_sum(Pair a, Pair b) {
    Pair sum = two_sum(a.hi, b.hi);
    PRECISE float lo = sum.lo + (a.lo + b.lo);
    return two_sum(sum.hi, lo);
}

Pair pair_product(Pair a, Pair b) { return normalised(add_product(Pair(0.0, 0.0), a, b)); }

Pair pair_quotient(Pair a, Pair b) {
    PRECISE float first = a.hi / b.hi;
    Pair rest = add_product(a, b, Pair(-first, 0.0));
    PRECISE float second = (rest.hi + rest.lo) / b.hi;
    return two_sum(first, second);
}

// a < b, of normalised pairs.
bool is_less(Pair a, Pair b) { return a.hi < b.hi || (a.hi == b.hi && a.lo < b.lo); }
