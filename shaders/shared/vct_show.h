// Looking at the voxels themselves, for C and GLSL: what can be shown, and where the shader finds what it is asked.
#ifndef CANDIL_SHARED_VCT_SHOW_H
#define CANDIL_SHARED_VCT_SHOW_H

#include "shared/layout.h"

// As colours, the area-weighted mean of what an occupied cell holds on the side that is seen:
#define VCT_SHOW_NONE 0 // nothing of the kind: the scene's picture
#define VCT_SHOW_ALBEDO 1 // diffuse
#define VCT_SHOW_NORMAL 2 // 0.5 + 0.5 × its x, y, z
#define VCT_SHOW_EMISSION 3 // W/(m² sr)
#define VCT_SHOW_IRRADIANCE 4 // W/m²
#define VCT_SHOW_RADIANCE 5 // W/(m² sr), as cones find it: lamps that are aimed at one by one are dark
#define VCT_SHOW_COVERAGE 6 // share of the cell's faces across x, y, z that surfaces hide, both ways; in red, green, blue

// Uniform locations.
#define VCT_SHOW_WHERE 8 // uvec4: level, axis of a slice, its cell along that axis or NONE, pixels along a cell's side
#define VCT_SHOW_CORNER 9 // uvec2: pixel of the slice's top left corner

#endif
