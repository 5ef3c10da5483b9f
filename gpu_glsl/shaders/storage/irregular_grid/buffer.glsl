// Irregular grids in buffer textures (storage/irregular_grid/irregular_cells.glsl).
#pragma once
#include "lib/dialect.glsl"

UBUFFER(nodes)
UBUFFER(cells)
UBUFFER(references)
BUFFER(triangles)

uint node_word(int index) { return FETCHBUFFER(nodes, index).x; }
uvec4 cell_record(int index) { return FETCHBUFFER(cells, index); }
uint reference_word(int index) { return FETCHBUFFER(references, index).x; }
vec4 triangle_texel(int index) { return FETCHBUFFER(triangles, index); }

#include "storage/irregular_grid/irregular_cells.glsl"
