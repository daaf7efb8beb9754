// Shadow maps of point, spot and directional lights, for C and GLSL: what a map sees, and where shaders find them.
//
// A map is a layer of one depth texture. Its texel at (X, Y), both −1…1, looks from `eye` along
//     z + X · half_x · x + Y · half_y · y         near > 0: perspective, depth = near / (distance along z)
// or from eye + X · half_x · x + Y · half_y · y along z     near = 0: parallel, depth = 1 − (distance along z) / range.
// Depth grows towards the light, and both are linear over the image of any plane; 0: nothing there.
#ifndef CANDIL_SHARED_SHADOW_H
#define CANDIL_SHARED_SHADOW_H

#include "shared/layout.h"

#define SHADOW_LIGHTS_MAX 16 // LIMIT_MAP_LIGHTS
#define SHADOW_FACES 6 // of a cube about a light, in the order +x −x +y −y +z −z
#define SHADOW_MAPS_MAX 96

// Four vectors of four of a uniform block, std140. Metres, relative to the blob's origin.
struct shadow_map {
	float eye[3];
	float near;
	float x[3]; // unit
	float half_x; // perspective: at distance 1
	float y[3]; // unit
	float half_y;
	float z[3]; // unit, away from the light
	float range;
};
LAYOUT_ASSERT(shadow_map, 64)
#define UNIFORM_SHADOW_MAPS 2 // uniform block binding

#define SHADOW_MAPS_UNIT 8 // texture

#define BIND_SHADOW_LIGHTS 29 // storage block: for each light of the scene its first map, or NONE
#define SHADOW_CUBE 0x80000000u // bit of it: there are SHADOW_FACES

#define SHADOW_LAYER 9 // uniform location, uint: the map being drawn

// The receiver is lifted off its surface by so many texels' breadth, for rounding's sake and because the filter, which
// reaches a texel and a half to every side, takes the wall beside a corner for an obstacle. More would lose the shadow of
// what is nearer than that: in Sponza, errors double with each doubling of it.
#define SHADOW_LIFT 0.5

#endif
