#include "core/judge.h"

namespace onepass {

std::string_view to_string(HitClass hit_class) {
    static constexpr std::array<std::string_view, kHitClassCount> kNames = {
        "agree", "tie", "edge", "false_miss", "false_hit", "wrong_surface", "t_error"};
    return kNames[static_cast<size_t>(hit_class)];
}

}  // namespace onepass
