//! strategy: irregular_grid
//! summary: the robust walk through cells of any size: divided, merged and expanded as triangles ask
//! source: Kalojanov, Billeter & Slusallek 2011; Perard-Gayot, Kalojanov & Slusallek 2017
//! structure: irregular_grid
//! storage: buffer ssbo
//! entries: fragment compute
//! gl: 4.3
//! twin: yes
//! param: test_boxes integer 1 walk through an instance only if the ray meets its box; 0 if both are in a cell
//! param: decide choice(doubles,floats) doubles what decides where floats cannot tell; floats err
//! param: any_hit integer 1 shadow rays end at the first sure hit, those of an image only on a software renderer; 0 finds their nearest
//! param: records choice(auto,floats,fixed) auto what a triangle test reads: 48 bytes of floats or 32 of fixed-point numbers; auto: fixed on a software renderer
//! param: pairs choice(auto,on,off) auto a fragment casts two given rays; auto: if a software renderer gains by it
//! param: specialise integer 1 leave out what the scene lacks; 0: one shader for all scenes

// The walk is that of `grid`, over another structure: small cells where triangles are small, large
// ones where little or nothing is.
//
// Cells are boxes of places in one fine lattice. The walk knows its place; the storage finds the
// cell that answers for it (storage/irregular_grid/irregular_cells.glsl), and the ray goes on to
// where it leaves that cell's box: as `grid` leaves a cube of empty cells, and for the same reason
// without loss. A box may reach over its neighbours, as long as the cell's list names all of their
// triangles: so the place beyond it is all that is needed to go on.
#pragma once
#include "strategies/grid.glsl"
