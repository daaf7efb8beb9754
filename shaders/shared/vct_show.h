// Displaying the voxels themselves: what can be shown, and the shader's uniforms. Used by C and GLSL.
#ifndef CANDIL_SHARED_VCT_SHOW_H
#define CANDIL_SHARED_VCT_SHOW_H

#include "shared/layout.h"

// Each shows, as a colour, the area-weighted mean of an occupied cell's contents on the side that is seen:
#define VCT_SHOW_NONE 0 // none of these: the normal picture
#define VCT_SHOW_ALBEDO 1 // diffuse albedo
#define VCT_SHOW_NORMAL 2 // 0.5 + 0.5 × normal
#define VCT_SHOW_EMISSION 3 // W/(m² sr)
#define VCT_SHOW_IRRADIANCE 4 // W/m²
#define VCT_SHOW_RADIANCE 5 // W/(m² sr), as cones find it; lamps that are sampled directly are dark
#define VCT_SHOW_COVERAGE 6 // coverage of the cell across x, y, z, sum of both directions; as red, green, blue

// Uniform locations.
#define VCT_SHOW_WHERE 8 // uvec4: level, axis of a slice, its cell along that axis or NONE, pixels along a cell's side
#define VCT_SHOW_CORNER 9 // uvec2: pixel of the slice's top left corner

#endif
