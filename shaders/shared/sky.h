// The environment map on OpenGL: the map itself, and its means over cones. Used by C and GLSL.
#ifndef CANDIL_SHARED_SKY_H
#define CANDIL_SHARED_SKY_H

#define SKY_PICTURE_UNIT 9 // texture: the map's texels, bilinear, rows from the top
#define SKY_CONES_UNIT 10 // texture array: a layer for each cone width; texels are means over cones

// Layer i is for cones whose half aperture has the tangent SKY_TANGENT_LEAST · 2^i. Cones narrower than SKY_TANGENT_SHARP
// read the map itself.
#define SKY_CONES_WIDTH 64
#define SKY_CONES_HEIGHT 32
#define SKY_CONES_LAYERS 5
#define SKY_TANGENT_LEAST 0.0625f
#define SKY_TANGENT_SHARP 0.04f

#endif
