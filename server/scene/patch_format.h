// What files of a finished radiosity solution hold, as they lie in a scene's blob: elements, which are the faces of a PLY,
// and rows of form factors, which are those of a Matrix Market file. The worker writes such files (patch_file.h), and the
// loader reads them. Any thread.
#ifndef CANDIL_SCENE_PATCH_FORMAT_H
#define CANDIL_SCENE_PATCH_FORMAT_H

#include <stdint.h>

#include "protocol/limits.h"

// A row sums up to at most 1, and more by mirrors alone: a share counts for each surface that it meets on its way. The rest
// is for rounding: each of its floats is off by less than 2^-22 of itself.
#define IMPORTED_ROW_MOST ((1 + LIMIT_RADIOSITY_BOUNCES) * (1 + 0x1p-20))

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

// A row of form factors: where its entries are. Rows lie in order and side by side.
struct imported_row {
	uint32_t first, count;
};

// An entry: the share of the light of the row's element that arrives at element `column`. Columns of a row ascend.
struct imported_factor {
	uint32_t column;
	float value; // from 0 on; a row's sum up to IMPORTED_ROW_MOST
};

// What is wrong with element `i` of `count`, as a phrase; NULL: nothing. Static storage.
const char *imported_element_fault(const struct imported_element *element, uint32_t i, uint32_t count);

// The same of a row of so many entries, of a matrix of `side` columns. That its sum is more than 1 is no fault.
const char *imported_row_fault(const struct imported_factor *entries, uint32_t count, uint32_t side);

#endif
