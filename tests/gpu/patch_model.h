// Scenes for the tests of radiosity's passes, made in memory, with a tree to trace rays through.
#ifndef CANDIL_TESTS_PATCH_MODEL_H
#define CANDIL_TESTS_PATCH_MODEL_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/element_buffers.h"

#define MODEL_TRIANGLES 4096u

struct patch_model {
	struct vertex vertices[3 * MODEL_TRIANGLES]; // three for each triangle
	struct vertex_color colors[3 * MODEL_TRIANGLES]; // used if has_colors
	struct triangle triangles[MODEL_TRIANGLES];
	struct leaf_triangle leaves[MODEL_TRIANGLES];
	uint32_t count;
	bool has_colors;
	struct material materials[8]; // white and diffuse, until a test changes them
	struct texture_info textures[4];
	uint32_t texture_count;
	uint32_t texels[4096];
	uint32_t texel_count;
	struct punctual_light lights[8];
	uint32_t light_count;
	struct bvh_node *nodes;
	struct blob_header header;
	struct resident_scene scene; // its view looks at all of the above
	struct elements elements;
	struct element_buffers buffers;
};

extern struct device *device;
extern const struct plan everything; // all effects

// Open the device. False: there is none, and the test is skipped.
bool model_test_begin(void);
int model_test_end(void); // number of failures: of the device's checks, and of memory that is left

void model_start(struct patch_model *model);
// `uv` may be NULL: (0, 0) (1, 0) (0, 1).
void model_add(struct patch_model *model, const double a[3], const double b[3], const double c[3], const double uv[3][2],
	       uint32_t material);
// Its texture coordinates are 0 … 1 along u and v.
void model_add_quad(struct patch_model *model, const double at[3], const double u[3], const double v[3], uint32_t material);
// Any convex flat quad; texture coordinates are its places along x and y.
void model_add_corners(struct patch_model *model, const double corners[4][3], uint32_t material);
// After the last triangle: the tree, the view, elements of sides no longer than `edge`, and their buffers.
void model_close(struct patch_model *model, double edge);
void model_finish(struct patch_model *model);

// Read what the elements are made of, by element.
void model_surfaces(const struct patch_model *model, struct radiosity_surface *out);

// A function of a place and whatever its maker needs: of `value` three numbers.
typedef void model_field(const double at[3], const void *data, double value[3]);

// Its mean over a patch, by n² places in each triangle of a fan.
void model_mean(const struct patch_model *model, uint32_t patch, uint32_t n, model_field *field, const void *data,
		double mean[3]);

#endif
