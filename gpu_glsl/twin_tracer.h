// A strategy's shader text run as C++: a tracer like any other.
#pragma once

#include <memory>
#include <string>

#include "core/tracer.h"
#include "gpu_glsl/prepared_strategy.h"
#include "gpu_glsl/twin/twin_unit.h"

namespace onepass {

/// All threads. A fetch out of range throws Error from cast() or render().
std::unique_ptr<Tracer> make_twin_tracer(std::string name, PreparedStrategy prepared,
                                         const twin::Unit& unit);

}  // namespace onepass
