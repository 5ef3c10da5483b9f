// Moved to core/random.h, where scenes can see it too.
#pragma once

#include "core/random.h"
