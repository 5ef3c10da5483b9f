// Embree, the oracle, as tracers: fast and robust, one thread and all threads.
#pragma once

#include <vector>

#include "core/catalogue.h"

namespace onepass {

/// embree/robust/threads, embree/fast/threads, embree/robust/1thread, embree/fast/1thread. The
/// first is the reference of every check.
std::vector<CatalogueEntry> embree_tracers();

/// "Embree 3.13.5 (Debian build with assertions), ..." for manifests and `doctor`.
std::string embree_description();

}  // namespace onepass
