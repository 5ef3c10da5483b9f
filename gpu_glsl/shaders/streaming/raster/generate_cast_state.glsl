// Raster form: what generate writes for given rays: no more than the control word.
#include "streaming/raster/own_state.glsl"

void store_control(uint control) { out_control = control; }
