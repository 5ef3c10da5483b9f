// The flat grid in buffer textures (storage/flat_grid/flat_cells.glsl).
#pragma once
#include "lib/dialect.glsl"
#include "storage/two_level_grid/triangle_buffers.glsl"

UBUFFER(cells)

uint cell_word(int index) { return FETCHBUFFER(cells, index).x; }

#include "storage/flat_grid/flat_cells.glsl"
