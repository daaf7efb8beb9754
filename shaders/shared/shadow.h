// Shadow maps of point, spot and directional lights: their projection, and where shaders find them. Used by C and GLSL.
//
// A map is one layer of a depth texture array. Its texel at (X, Y), both −1…1, looks from `eye` along
//     z + X · half_x · x + Y · half_y · y         near > 0: perspective, depth = near / (distance along z)
// or from eye + X · half_x · x + Y · half_y · y along z near = 0: parallel, depth = 1 − (distance along z) / range. Depth
// grows towards the light, and both kinds are linear over the image of a plane. Depth 0: nothing there.
#ifndef CANDIL_SHARED_SHADOW_H
#define CANDIL_SHARED_SHADOW_H

#include "shared/layout.h"

#define SHADOW_LIGHTS_MAX 16 // LIMIT_MAP_LIGHTS
#define SHADOW_FACES 6 // faces of a cube about a light, in the order +x −x +y −y +z −z
#define SHADOW_MAPS_MAX 96

// Four vectors of four in a std140 uniform block. Metres, relative to the blob's origin.
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

#define BIND_SHADOW_LIGHTS 29 // storage block: for each light of the scene the number of its first map, or NONE
#define SHADOW_CUBE 0x80000000u // bit of that number: the light has SHADOW_FACES maps

#define SHADOW_LAYER 9 // uniform location, uint: the map being drawn

// The receiver is lifted off its surface by the breadth of this many texels. The lift covers rounding. It is also needed
// because the filter reaches one and a half texels to every side, where a wall beside a corner would count as an obstacle.
// A larger lift would lose the shadows of nearer objects: in Sponza, errors double with each doubling of it.
#define SHADOW_LIFT 0.5

#endif
