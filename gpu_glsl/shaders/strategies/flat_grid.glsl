//! strategy: flat_grid
//! summary: the robust walk through one grid that holds the triangles of all instances in the world
//! source: the walk of `grid`; one level after Fujimoto, Tanaka & Iwata 1986
//! structure: flat_grid
//! storage: buffer ssbo
//! entries: fragment compute
//! gl: 4.3
//! twin: yes
//! default: no
//! param: skip_empty integer 1 cross empty space at once; 0 walks it cell by cell
//! param: decide choice(doubles,floats) doubles what decides where floats cannot tell; floats err
//! param: any_hit integer 1 shadow rays end at the first sure hit, those of an image only on a software renderer; 0 finds their nearest
//! param: records choice(auto,floats,fixed) auto what a triangle test reads: 48 bytes of floats or 32 of fixed-point numbers; auto: fixed on a software renderer
//! param: pairs choice(auto,on,off) auto a fragment casts two given rays; auto: if a software renderer gains by it
//! param: specialise integer 1 leave out what the scene lacks; 0: one shader for all scenes

// The walk is that of `grid`, but each ray takes only one: through a grid over the triangles of all
// instances, as they stand in the world. A scene of a few instances gains by it, because a ray is
// prepared once and not once an instance; a scene that shares large objects pays in memory, and one
// whose instances are of very different sizes in triangles tested.
//
// What is asked of a triangle that floats cannot rule out is asked in its own instance's frame, as
// `grid` asks it (storage/flat_grid/flat_cells.glsl): the answers are the same, bit by bit.
#pragma once
#include "strategies/grid.glsl"
