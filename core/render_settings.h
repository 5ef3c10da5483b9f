// What a rendered frame is asked to contain.
#pragma once

#include <cstdint>

namespace onepass {

struct RenderSettings {
    uint32_t width = 512;    ///< pixels; the paper's 512 x 512
    uint32_t height = 512;   ///< pixels
    uint32_t max_depth = 4;  ///< mirror bounces after the primary ray; 0 turns reflections off
    bool shadows = true;
    bool aovs = true;  ///< ids, t, u, v, normal and counters beside the colour
};

}  // namespace onepass
