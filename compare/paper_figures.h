// What the paper printed: the figures that ours stand beside.
//
// Source: Adinetz & Berezin, "Implementing Classical Ray Tracing on GPU - a Case Study of GPU
// Programming", Moscow State University, c. 2006: tables 1 and 2, and the captions of figures 1 and
// 4. ATI X1800 XL, 512 x 512 pixels, shadow and reflection rays on.
#pragma once

#include <cstdint>
#include <string_view>

namespace onepass {

inline constexpr char kPaperSource[] =
    "Adinetz & Berezin, Implementing Classical Ray Tracing on GPU – a Case Study of GPU "
    "Programming, Moscow State University, c. 2006";
inline constexpr char kPaperDevice[] = "ATI X1800 XL, OpenGL 2.0";

/// Pixels a side of the paper's images, and of ours beside them.
inline constexpr uint32_t kPaperImageSide = 512;

struct PaperScene {
    std::string_view name;     ///< of our stand-in
    std::string_view printed;  ///< as the paper spells it
    uint64_t triangles = 0;    ///< 0: the paper gives no counts
    uint64_t instances = 0;
    uint64_t lights = 0;
    double frames_per_s = 0.0;

    /// How the paper counts: one primary ray a pixel.
    constexpr double primary_mrays_per_s() const {
        return frames_per_s * kPaperImageSide * kPaperImageSide / 1e6;
    }
};

inline constexpr PaperScene kPaperScenes[] = {
    {"chair-wood", "Chair_wood", 33404, 11, 1, 12.8},
    {"palm-pc", "PalmPC", 13532, 7, 1, 6.3},
    {"balls-1", "Balls-1", 31200, 10, 2, 5.8},
    {"knife", "Knife", 1676, 1, 1, 16.0},
    {"sr71a", "SR71A", 4446, 1, 1, 7.9},
    {"palace", "Palace", 33000, 36, 1, 10.1},
    {"hind24", "Hind24", 0, 24, 0, 6.0},
};

}  // namespace onepass
