// The flat grid in buffer textures (storage/flat_grid/flat_cells.glsl).
#pragma once
#include "lib/renderer.glsl"
#include "storage/two_level_grid/triangle_buffers.glsl"

WORD_TABLE(cells)

uint cell_word(int index) { return FETCHWORD(cells, index); }

#include "storage/flat_grid/flat_cells.glsl"
