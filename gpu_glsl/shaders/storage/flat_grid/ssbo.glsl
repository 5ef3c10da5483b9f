// The flat grid in shader storage buffers (storage/flat_grid/flat_cells.glsl). What is read once a
// ray or a decision stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"
#include "storage/two_level_grid/triangle_blocks.glsl"

STORAGE(cells_block, uint, cells)

uint cell_word(int index) { return FETCHSTORAGE(cells, index); }

#include "storage/flat_grid/flat_cells.glsl"
