// Patches of radiosity as shaders see them. Shared by C and GLSL.
//
// A patch has two elements, its sides: element i is the front of patch i, element i + (number of patches) its back. The
// front is the side from which its corners run counter-clockwise.
#ifndef CANDIL_SHARED_RADIOSITY_H
#define CANDIL_SHARED_RADIOSITY_H

#include "shared/bindings.h"

// Storage buffers of the passes on Vulkan, beside the scene's. Each pass has its own beside them, from BIND_RADIOSITY_OWN
// on.
#define BIND_RADIOSITY_FACES 16 // struct radiosity_face, by face
#define BIND_RADIOSITY_TRIANGLES 17 // a word for each triangle: RADIOSITY_FACE_… below
#define BIND_RADIOSITY_PATCHES 20 // struct radiosity_patch, by patch
#define BIND_RADIOSITY_SURFACES 21 // struct radiosity_surface, by element
#define BIND_RADIOSITY_OWN 22
#define BIND_RADIOSITY_COUNT 26

// The word of a triangle: NONE for one without an area, else its face, which of a quad's two triangles it is, and which of
// its own corners is the face's corner 0.
#define RADIOSITY_FACE_SHIFT 3u
#define RADIOSITY_FACE_SECOND 4u // it is of the face's corners 0 2 3, else of 0 1 2
#define RADIOSITY_FACE_TURN 3u // mask

// A face that is cut into patches (server/worker/technique/radiosity/patches.h). With the corners c0 … c3 of a quad, c2 - c0
// = x2 (c1 - c0) + y2 (c3 - c0); of a parallelogram both are 1.
struct radiosity_face {
	uint first; // its first patch
	uint u, v; // parts of a quad's sides 0 1 and 1 2; of each side of a triangle u, and v is 0
	float x2, y2;
};
LAYOUT_ASSERT(radiosity_face, 20)

// A patch: corners in metres relative to the blob's origin. Of a triangle the last is the third again.
struct radiosity_patch {
	float corner[12];
	float area; // m²
	float share; // of it that the triangle of corners 0 1 2 has, 0…1
	uint face;
	uint triangle; // that its first corner is on; of a quad that two triangles share, the first
	uint covered; // on the device, once surfaces.h is through: radiosity/cover.glsl
};
LAYOUT_ASSERT(radiosity_patch, 68)

// Parts of a patch that may be covered, along each side of the unit square that is mapped to it. The low bits tell those
// that are inside of another body, and the bits above them those from which at least half of the rays meet backs.
#define PATCH_COVER_SIDE 4u
#define PATCH_COVER_PARTS 16u
#define PATCH_COVER_ALL 0xFFFFu

// What a side of a patch is made of, means over its area.
struct radiosity_surface {
	float emission[3]; // radiance, W/(m² sr)
	float albedo[3]; // diffuse reflectance
	float mirror[3]; // specular reflectance of what is polished, in the mirror's direction
	float there; // share of the patch that is there, by masks
};
LAYOUT_ASSERT(radiosity_surface, 40)

#endif
