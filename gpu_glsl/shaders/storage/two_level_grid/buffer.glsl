// The two-level grid in buffer textures (storage/two_level_grid/grid_buffers.glsl).
#pragma once
#include "lib/renderer.glsl"
#include "storage/two_level_grid/triangle_buffers.glsl"

WORD_TABLE(cells)

uint cell_word(int index) { return FETCHWORD(cells, index); }

#include "storage/two_level_grid/grid_buffers.glsl"
#include "storage/two_level_grid/uniform_cells.glsl"
#include "storage/two_level_grid/walked_instance.glsl"
