// Embree, the oracle, as tracers: fast and robust, one thread and all threads, one ray a call and
// many.
#pragma once

#include <vector>

#include "core/catalogue.h"

namespace onepass {

/// The entries. Rays that Embree would abort on are answered as misses flagged
/// kFlagOracleInvalid (see cpu_ref/embree_scene.h). For Query::any only Hit::is_hit() is an answer.
/// device_ms is NaN; wall_ms is the loop over the rays.
///
/// embree/robust/threads, embree/fast/threads, embree/robust/1thread, embree/fast/1thread: one ray
/// a call. The first is the reference of every check.
///
/// embree/MODE/packet8, embree/MODE/packet16, embree/MODE/stream: many rays a call, on all threads;
/// cast only, and taken only by name. `coherence=auto` tells Embree that rays are coherent where
/// are_coherent() says so; the cost "coherent" of a cast says what it was told.
std::vector<CatalogueEntry> embree_tracers();

/// "Embree 3.13.5 (Debian build with assertions), ..." for manifests and `doctor`.
/// Throws: Error of Kind::device if Embree cannot open a device.
std::string embree_description();

}  // namespace onepass
