// The frames in which objects are stored for shaders, and the maps that take rays there.
#pragma once

#include "core/affine.h"
#include "core/bounds.h"
#include "core/types.h"

namespace onepass {

/// The frame in which all of an object is stored: q = scale (p - origin), exact for every vertex.
struct GridFrame {
    dvec3 origin{0.0};
    double scale = 1.0;  ///< a power of two
};

/// On each axis: the lower bound, if the numbers of the box are within a factor of 2 of each other,
/// so that subtracting it is exact (Sterbenz); else 0, and then no number of the box is larger than
/// twice its extent.
dvec3 frame_origin(const Bounds& bounds);

/// The power of two that takes a length to 1/2 to 1; for lengths below 2^-100 or above 2^100, and
/// for 0, the one that takes those.
double frame_scale(double largest);

/// The largest coordinate becomes 1/2 to 1, so that areas and volumes neither overflow nor vanish.
/// `bounds` must not be flat (core/grid/sizing.h: padded_bounds).
GridFrame object_frame(const Bounds& bounds);

/// The centre of a box, as floats hold it in the frame.
dvec3 centre_in(const Bounds& box, const GridFrame& frame);

/// A point of an object as it stands in the world, less `from`: within 2^-52 of itself and 2^-100
/// of what it is made of, however much of that cancels.
dvec3 world_point(const Affine& world_from_object, const vec3& point, const dvec3& from);

/// The map from the world to an instance's frame, as shared/grid_buffers_layout.h says of
/// kInstanceRowTexels: 24 floats.
void put_instance_rows(float* out, const Affine& world_from_object, const GridFrame& frame);

}  // namespace onepass
