// Records of the shading tables, in texels of four floats. One text for C++ and GLSL.
#pragma once

// Flat scenes: the geometric normal. Smooth ones: the three vertex normals after it. All in object
// space; w of the first texel is the triangle's group.
const int kFlatNormalTexels = 1;
const int kSmoothNormalTexels = 4;

// The rows of object_from_world (its linear part), then (first triangle, first material, 0, 0).
const int kShadingInstanceTexels = 4;

// (diffuse, reflectivity), (specular, shininess); one record an instance and group.
const int kMaterialTexels = 2;

// (position, 0), (intensity, 0).
const int kLightTexels = 2;
