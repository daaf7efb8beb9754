// Pictures of radiosity on OpenGL: uniform locations and texture units. Used by C and GLSL.
#ifndef CANDIL_SHARED_RADIOSITY_SHOW_H
#define CANDIL_SHARED_RADIOSITY_SHOW_H

// Texel buffers, a word a texel.
#define RADIOSITY_FACES_UNIT 1 // uint: struct radiosity_face, by face
#define RADIOSITY_TRIANGLES_UNIT 2 // uint: the word of each triangle
#define RADIOSITY_VALUES_UNIT 3 // float: three an element; or four at a time, three for each of its four corners
// Of the scene's buffers again, four words a texel.
#define RADIOSITY_CORNERS_UNIT 4 // uint: struct triangle, by triangle
#define RADIOSITY_VERTICES_UNIT 5 // float: struct vertex, two a vertex
#define RADIOSITY_MATERIALS_UNIT 6 // uint: struct material, nine a material
// The same, a word a texel.
#define RADIOSITY_TEXTURES_UNIT 7 // uint: struct texture_info, ten a texture
#define RADIOSITY_TEXELS_UNIT 8 // uint
#define RADIOSITY_SRGB_UNIT 11 // float
#define RADIOSITY_SKY_UNIT 12 // uint: struct environment_row of the environment, two a row

#define RADIOSITY_FACE_WORDS 5
#define RADIOSITY_TEXTURE_WORDS 10
#define RADIOSITY_MATERIAL_TEXELS 9

// Uniform locations.
#define RADIOSITY_PATCHES 8 // uint: their number
#define RADIOSITY_RAYS 9 // uvec3: the first ray of a pixel's sample that is this pass's, the first that is not, and all

#endif
