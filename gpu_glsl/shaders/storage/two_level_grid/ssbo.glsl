// The two-level grid in shader storage buffers (storage/two_level_grid/grid_buffers.glsl). What is
// read once a ray or an instance stays in buffer textures.
#pragma once
#include "lib/dialect.glsl"
#include "storage/two_level_grid/triangle_blocks.glsl"

STORAGE(cells_block, uint, cells)

uint cell_word(int index) { return FETCHSTORAGE(cells, index); }

#include "storage/two_level_grid/grid_buffers.glsl"
#include "storage/two_level_grid/uniform_cells.glsl"
#include "storage/two_level_grid/walked_instance.glsl"
