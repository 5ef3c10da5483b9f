// Irregular grids in buffer textures (storage/irregular_grid/irregular_cells.glsl).
#pragma once
#include "lib/dialect.glsl"

UBUFFER(nodes)
UBUFFER(cells)
UBUFFER(references)
BUFFER(planes)
UBUFFER(corners)
UBUFFER(vertices)

uint node_word(int index) { return FETCHBUFFER(nodes, index).x; }
uvec4 cell_record(int index) { return FETCHBUFFER(cells, index); }
uint reference_word(int index) { return FETCHBUFFER(references, index).x; }
vec4 planes_texel(int index) { return FETCHBUFFER(planes, index); }
uint corner_word(int index) { return FETCHBUFFER(corners, index).x; }
uint vertex_word(int index) { return FETCHBUFFER(vertices, index).x; }

#include "storage/irregular_grid/irregular_cells.glsl"
