// Pictures of radiosity on OpenGL: uniform locations and texture units. Used by C and GLSL.
#ifndef CANDIL_SHARED_RADIOSITY_SHOW_H
#define CANDIL_SHARED_RADIOSITY_SHOW_H

// Texel buffers, a word a texel.
#define RADIOSITY_FACES_UNIT 1 // uint: struct radiosity_face, by face
#define RADIOSITY_TRIANGLES_UNIT 2 // uint: the word of each triangle
#define RADIOSITY_VALUES_UNIT 3 // float: three an element, or three for each of its four corners

#define RADIOSITY_FACE_WORDS 5

// Uniform locations.
#define RADIOSITY_PATCHES 8 // uint: their number
#define RADIOSITY_RAYS 9 // uvec3: the first ray of a pixel's sample that is this pass's, the first that is not, and all

#endif
