// Random numbers that are the same on every machine.
//
// std::mt19937_64 is specified bit by bit; the standard's distributions and std::shuffle are not,
// so the conversions are spelled out here.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <utility>

namespace onepass {

class Random {
  public:
    explicit Random(uint64_t seed) : engine_(seed) {}

    /// Uniform in [0, 1): the 24 high bits, so that every value is an exact float.
    float unit() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }

    /// Uniform in 0 .. n - 1, n > 0. The bias, n / 2^64, is far below what any run can show.
    uint64_t below(uint64_t n) { return engine_() % n; }

    /// Fisher-Yates.
    template <class T>
    void shuffle(std::span<T> values) {
        for (size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[below(i)]);
    }

  private:
    std::mt19937_64 engine_;
};

}  // namespace onepass
