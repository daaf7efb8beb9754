// Files of a finished solution: its patches as a PLY, and the form factors between their sides as a Matrix Market file. Both
// are of the elements in their order, the fronts of all patches and then their backs, and hold every float so that it can be
// read back bit for bit (of a corner its sum with the scene's origin, as a double). What they say of rows is of those that
// the solution's light reaches (reach.h), so that a request gives the same bytes whatever was asked for before. Made in
// slices. Device's thread only.
//
// PLY ("The PLY Polygon File Format", Turk 1994), binary, little-endian: corners as doubles, metres, world space; then face
// i, which is element i, seen from its own side: counter-clockwise. Its properties are corners (3 or 4), patch, side (0:
// front, 1: back), material, area (m²), B, M and D (b_r …, m_r …, d_r …: radiosity, emitted exitance, and irradiance that
// comes straight from its source, W/m²), reflectance (rho_r …), straight (1: D has the light of what emits, and form factors
// carry B - M alone), reached (1: light reaches it), escaped and cut (shares of its light that meet nothing, and that a
// limit of mirrors cut off), and H (h_r …: all irradiance, W/m²). So H = D + F (B - straight M), with F the form factors,
// and B = M + rho H, from which H cannot be had back bit for bit. patch_format.h lists the properties.
//
// Matrix Market ("The Matrix Market Exchange Formats", Boisvert, Pozo and Remington 1996), coordinate real general: row i,
// column j is the share of the light of element i - 1 that arrives at element j - 1, with nine digits.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCH_FILE_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_PATCH_FILE_H

#include "candil.pb.h"
#include "server/worker/technique/radiosity/solution.h"

struct patch_file;

// Begin a file of FORMAT_PLY or FORMAT_MTX. `solution`: a finished one, which is held by the caller until the file's end,
// and `scene` is the variant that it is shown of. `most`: bytes that it may have. STATUS_MEMORY; STATUS_LIMIT: it is known
// beforehand to become larger.
enum status patch_file_create(const struct solution *solution, const struct resident_scene *scene, candil_Format format,
			      uint64_t most, struct patch_file **file, struct error *err);
void patch_file_destroy(struct patch_file *file); // NULL is allowed

// Write for about budget_us. STATUS_MEMORY, STATUS_DEVICE; STATUS_LIMIT: it becomes larger than it may, and the sentence
// tells how large it would be.
enum status patch_file_step(struct patch_file *file, uint32_t budget_us, struct error *err);
bool patch_file_finished(const struct patch_file *file);
double patch_file_fraction(const struct patch_file *file); // 0…1

// Hand over the sealed memfd of a finished file, once. STATUS_INTERNAL: there is none.
enum status patch_file_take(struct patch_file *file, int *fd, uint64_t *bytes, struct error *err);

#endif
