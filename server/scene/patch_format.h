// What files of a finished radiosity solution hold, as they lie in a scene's blob: elements, which are the faces of a PLY,
// and rows of form factors, which are those of a Matrix Market file. The worker writes such files (patch_file.h), and the
// loader reads them (patch_ply.h, patch_matrix.h). What a face of the PLY has beside its corners is told here alone, by
// PATCH_PROPERTIES. Any thread.
#ifndef CANDIL_SCENE_PATCH_FORMAT_H
#define CANDIL_SCENE_PATCH_FORMAT_H

#include <stdint.h>

#include "protocol/limits.h"

// The most that a row of form factors sums up to: 1, and what rounding adds, which is less than 2^-22 of each. With mirrors
// a share counts for each surface that it meets on its way, so then a row may sum up to one more for each bounce.
#define IMPORTED_SUM_MOST (1 + 0x1p-20)
#define IMPORTED_ROW_MOST ((1 + LIMIT_RADIOSITY_BOUNCES) * IMPORTED_SUM_MOST)

// An element: one side of a patch. Element i of n is the front of patch i where i < n / 2, else the back of patch i - n / 2.
struct imported_element {
	// Corners, metres, world space, counter-clockwise seen from the element's own side; what is behind `corners` is 0.
	double corner[4][3];
	uint32_t patch; // its number
	uint32_t material; // its number in the scene that the file is of
	float area; // m²
	float b[3]; // radiosity B, W/m²
	float m[3]; // emitted exitance M, W/m²
	float d[3]; // irradiance D that comes straight from its source, W/m²
	float rho[3]; // diffuse reflectance, 0…1
	float h[3]; // irradiance H, all of it, W/m²; B = M + rho H, rounded
	float escaped,
	    cut; // shares of its light that meet nothing, and that a limit of mirrors cut off, 0…1; 0 if not reached
	uint8_t corners; // 3 or 4
	uint8_t side; // 0: front, 1: back
	uint8_t straight; // 1: D has the light of surfaces that emit, and form factors carry B - M alone; the same for all
	uint8_t reached; // 1: light reaches the element, so the file of form factors has a row for it
	uint32_t reserved; // 0
};

// What a face of the PLY has behind its corners, in this order: X(type of the PLY, name, member of struct imported_element).
#define PATCH_PROPERTIES(X) \
	X(uint, "patch", patch) \
	X(uchar, "side", side) \
	X(uint, "material", material) \
	X(float, "area", area) \
	X(float, "b_r", b[0]) \
	X(float, "b_g", b[1]) \
	X(float, "b_b", b[2]) \
	X(float, "m_r", m[0]) \
	X(float, "m_g", m[1]) \
	X(float, "m_b", m[2]) \
	X(float, "d_r", d[0]) \
	X(float, "d_g", d[1]) \
	X(float, "d_b", d[2]) \
	X(float, "rho_r", rho[0]) \
	X(float, "rho_g", rho[1]) \
	X(float, "rho_b", rho[2]) \
	X(uchar, "straight", straight) \
	X(uchar, "reached", reached) \
	X(float, "escaped", escaped) \
	X(float, "cut", cut) \
	X(float, "h_r", h[0]) \
	X(float, "h_g", h[1]) \
	X(float, "h_b", h[2])

// The list that its corners are: the types of its length and its items, and its name. And what a vertex has.
#define PATCH_LIST_LENGTH "uchar"
#define PATCH_LIST_ITEM "uint"
#define PATCH_LIST_NAME "vertex_indices"
#define PATCH_LIST PATCH_LIST_LENGTH " " PATCH_LIST_ITEM " " PATCH_LIST_NAME
#define PATCH_AXES(X) X(double, "x", corner[0]) X(double, "y", corner[1]) X(double, "z", corner[2])

// One of those properties.
struct patch_property {
	const char *type, *name;
	uint32_t offset, bytes; // of the member
};

// All of them, *count. Static storage.
const struct patch_property *patch_properties(uint32_t *count);

// Bytes of a face: its corners, of which it has at most four, and the properties.
#define PATCH_FACE_BYTES_MOST 112u

// Write the face of an element. `vertex`: numbers of its corners among the file's vertices. The bytes written, at most
// PATCH_FACE_BYTES_MOST.
uint32_t patch_face_write(const struct imported_element *element, const uint32_t vertex[4], char *out);

// A row of form factors: where its entries are. Rows lie in order and side by side.
struct imported_row {
	uint32_t first, count;
};

// An entry: the share of the light of the row's element that arrives at element `column`. Columns of a row ascend.
struct imported_factor {
	uint32_t column;
	float value; // from 0 on
};

// What is wrong with elements, as a phrase, and *which of them it is; NULL: nothing. Static storage.
const char *imported_elements_fault(const struct imported_element *elements, uint32_t count, uint32_t *which);

// The same of a row of so many entries, of a matrix of `side` columns. A sum of more than 1, up to IMPORTED_ROW_MOST, is no
// fault.
const char *imported_row_fault(const struct imported_factor *entries, uint32_t count, uint32_t side);

// What a row of so many entries sums up to.
double imported_row_sum(const struct imported_factor *entries, uint32_t count);

#endif
