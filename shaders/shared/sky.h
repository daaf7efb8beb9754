// The picture around the scene on OpenGL, for C and GLSL: as it is, and as cones see it.
#ifndef CANDIL_SHARED_SKY_H
#define CANDIL_SHARED_SKY_H

#define SKY_PICTURE_UNIT 9 // texture: its texels, bilinear, rows from the top
#define SKY_CONES_UNIT 10 // texture array: a layer for each width of cone, its texels the means over cones about them

// Layer i is of cones whose half aperture has the tangent SKY_TANGENT_LEAST · 2^i. Narrower ones than SKY_TANGENT_SHARP see
// the picture itself.
#define SKY_CONES_WIDTH 64
#define SKY_CONES_HEIGHT 32
#define SKY_CONES_LAYERS 5
#define SKY_TANGENT_LEAST 0.0625f
#define SKY_TANGENT_SHARP 0.04f

#endif
