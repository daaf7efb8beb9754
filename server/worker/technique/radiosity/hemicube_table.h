// What share of an element's light goes through each pixel of a hemicube: a box of side 2 about the element's point, of
// which the top face has n × n pixels and each of the four sides, of which only the upper half is above the element, n × n /
// 2 (Cohen and Greenberg 1985, "The hemi-cube"). Host only, any thread, no state.
//
//   top, z = 1      ∫∫ 1 / (π (x² + y² + 1)²) dx dy
//   side, y = 1     ∫∫ z / (π (x² + z² + 1)²) dx dz
//
// over a pixel: the cosine and the solid angle in closed form, so all pixels sum up to 1. The products of the middle of a
// pixel and its area, which papers print, sum up to 1 + 5e-4 at n = 32.
//
// By symmetry a table has two parts of n/2 × n/2 pixels, rows of x: a quarter of the top, from its middle outwards, and half
// of a side, from its middle outwards and from the element's plane upwards.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_TABLE_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_HEMICUBE_TABLE_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/error.h"

#define HEMICUBE_PIXELS_LEAST 2u
#define HEMICUBE_PIXELS_MOST 1024u

// Pixels of a table: of a hemicube 4 of the first half of them and 8 of the second.
static inline uint32_t hemicube_table_entries(uint32_t pixels)
{
	return pixels * pixels / 2;
}

// The share of the rectangle from (0, 0) to (x, y) of the top; and of that from (0, 0) to (x, z) of a side.
double hemicube_top_share(double x, double y);
double hemicube_side_share(double x, double z);

// The table: hemicube_table_entries(pixels) numbers. `middles`: the products named above instead. `pixels` is even, and
// HEMICUBE_PIXELS_LEAST … HEMICUBE_PIXELS_MOST. The caller frees *table. STATUS_MEMORY.
enum status hemicube_table_make(uint32_t pixels, bool middles, double **table, struct error *err);

// The same as whole numbers, of which `unit`, a multiple of 8, are a share of 1: the pixels of a hemicube sum up to exactly
// `unit` where those of the table sum up to 1. What rounding takes from a pixel its neighbour gets, so the sum over a run of
// pixels is off by less than 1.
void hemicube_table_round(uint32_t pixels, const double *table, uint32_t unit, uint32_t *words);

#endif
