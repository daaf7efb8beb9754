// What emits, and how often it is chosen.
#ifndef CANDIL_LOADER_LIGHTS_H
#define CANDIL_LOADER_LIGHTS_H

#include "server/loader/import.h"

// Set power_density of every material: π · mean luminance of its emission · sides.
void lights_weigh_materials(struct import *import);

// Emissive triangles of the final geometry, area · power_density their weight. *out is malloc'ed, NULL for none; *power in
// W.
enum status lights_collect_emitters(const struct material *materials, const struct vertex *vertices,
				    const struct triangle *triangles, uint32_t count, struct emitter **out,
				    uint32_t *emitter_count, float *power, struct error *err);

// The table over the punctual lights: point 4πI, spot I times the solid angle of its mean cone, directional E·π·radius².
// Black ones are left out. *out as above.
enum status lights_collect_punctual(const struct import *import, const double origin[3], double radius,
				    struct punctual_light **out, uint32_t *light_count, float *power, struct error *err);

#endif
