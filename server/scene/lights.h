// What emits, weighed and put into alias tables: by the loader for a scene, by a worker for a scene that a request edits.
// Equal input gives equal bits. One thread.
#ifndef CANDIL_SCENE_LIGHTS_H
#define CANDIL_SCENE_LIGHTS_H

#include "server/scene/blob.h"

// power_density of a material: π · mean luminance of the emission (its factor times the mean of its texture, in linear
// light) · the number of sides that emit, W/m². Reads all texels of its emission texture.
float lights_power_density(const struct material *material, const struct texture_info *textures, const uint32_t *texels);

// Of a triangle, m², from coordinates as they are: infinite where they are too large for a double's squares.
double lights_area(const struct vertex *vertices, const struct triangle *triangle);

// The triangles that emit, chosen by area · power_density. *out (to be freed; NULL without any) holds as many as *count;
// *power is the sum, W, cut to a float. Triangles whose weight is no normal number are left out. STATUS_MEMORY.
enum status lights_collect_emitters(const struct material *materials, const struct vertex *vertices,
				    const struct triangle *triangles, uint32_t count, struct emitter **out,
				    uint32_t *emitter_count, float *power, struct error *err);

// The radius of a sphere about the bounds, metres; 1 for a scene without extent.
double lights_bounding_radius(const float min[3], const float max[3]);

// Fill in the table of the lights, in place, chosen by power: 4π · luminance of a point light, 2π(1 − mean cosine) of a
// spot's, π · radius² of a directional one's, which is what meets a sphere of `radius` about the scene. Those without
// weight go, the others close up: *count becomes smaller and place[i], unless `place` is NULL, says where light i went, or
// NONE. *power is the sum, W, cut to a float. STATUS_MEMORY.
enum status lights_make_table(struct punctual_light *lights, uint32_t *count, double radius, uint32_t *place, float *power,
			      struct error *err);

#endif
