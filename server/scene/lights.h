// The lamps of a scene, weighted by power and put into alias tables: by the loader for a scene, by a worker for a scene
// that a request edits. Equal input gives equal bits. One thread.
#ifndef CANDIL_SCENE_LIGHTS_H
#define CANDIL_SCENE_LIGHTS_H

#include "server/scene/blob.h"

// power_density of a material, W/m²: π · mean luminance of the emission · number of sides that emit. The emission is its
// factor times the mean of its texture in linear light; all texels of the texture are read.
float lights_power_density(const struct material *material, const struct texture_info *textures, const uint32_t *texels);

// Set that of `count` materials, whose textures are among `texture_count`. Each image is read once. STATUS_MEMORY.
enum status lights_power_densities(struct material *materials, uint32_t count, const struct texture_info *textures,
				   uint32_t texture_count, const uint32_t *texels, struct error *err);

// The luminance of each of `count` factors times a texture, in linear light: the means over each cell of a grid of width ·
// height cells, no more than the texture has texels, into `out`, which is zeroed: row by row, and of each cell factor by
// factor.
void lights_texture_luminance(const struct texture_info *texture, const uint32_t *texels, const float (*factors)[3],
			      uint32_t count, uint32_t width, uint32_t height, float *out);

// A light's range in metres as struct punctual_light has it: never 0 for a range above zero, and 0, which is no bound, for
// one beyond LIMIT_COORDINATE.
float lights_range(double metres);

// The area of a triangle, m². Infinite if the squares of the coordinates exceed a double.
double lights_area(const struct vertex *vertices, const struct triangle *triangle);

// List the triangles that emit as an alias table by area · power_density. *out, which the caller frees, has *emitter_count
// rows; it is NULL if there are none. *power is the sum, W, limited to a float's range. Triangles whose weight is not a
// normal number are left out. STATUS_MEMORY.
enum status lights_collect_emitters(const struct material *materials, const struct vertex *vertices,
				    const struct triangle *triangles, uint32_t count, struct emitter **out,
				    uint32_t *emitter_count, float *power, struct error *err);

// The radius, in metres, of a sphere about the bounds; 1 for a scene without extent.
double lights_bounding_radius(const float min[3], const float max[3]);

// Make `lights` an alias table by power, in place. The power is 4π · luminance for a point light, 2π(1 − mean cosine) ·
// luminance for a spot light. For a directional light it is π · radius² · luminance, the power through a sphere of `radius`
// metres about the scene. Lights without weight are removed and the others close up, so that *count becomes smaller.
// place[i], unless `place` is NULL, becomes the new index of light i, or NONE. *power is the sum, W, limited to a float's
// range. STATUS_MEMORY.
enum status lights_make_table(struct punctual_light *lights, uint32_t *count, double radius, uint32_t *place, float *power,
			      struct error *err);

#endif
