#include "scenes/ladders.h"

#include <iterator>

#include "scenes/ladders/parts.h"

namespace onepass {
namespace {

std::vector<Ladder> all_ladders() {
    std::vector<Ladder> all;
    for (auto* theme : {ladder::place_ladders, ladder::shape_ladders, ladder::aim_ladders,
                        ladder::transform_ladders, ladder::limit_ladders}) {
        std::vector<Ladder> some = theme();
        std::move(some.begin(), some.end(), std::back_inserter(all));
    }
    return all;
}

}  // namespace

const std::vector<Ladder>& ladders() {
    static const std::vector<Ladder> kLadders = all_ladders();
    return kLadders;
}

}  // namespace onepass
