// The number of a pixel in a row-major image.
#pragma once

int place(ivec2 at, int width) { return at.y * width + at.x; }
