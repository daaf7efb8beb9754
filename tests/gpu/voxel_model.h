// Scenes for the voxels' test, made in memory, and what their voxels must be, computed in double precision.
#ifndef CANDIL_TESTS_VOXEL_MODEL_H
#define CANDIL_TESTS_VOXEL_MODEL_H

#include <stdbool.h>

#include "server/worker/scenes/resident.h"
#include "shaders/shared/voxel.h"

// A scene that owns its sections. Zeroed is empty.
struct model {
	struct vertex *vertices;
	struct triangle *triangles;
	uint32_t vertex_count, triangle_count;
	struct material materials[4];
	struct texture_info texture;
	uint32_t texels[64];
	struct blob_header header;
	struct resident_scene scene; // its view looks at all of the above
};

void model_init(struct model *model); // every material white
void model_finish(struct model *model); // what is derived from it, too

void model_add(struct model *model, const double a[3], const double b[3], const double c[3], uint32_t material);
void model_add_sphere(struct model *model, const double middle[3], double radius, uint32_t rings, uint32_t material);
void model_add_quad(struct model *model, const double corner[3], const double u[3], const double v[3], uint32_t material);

// To be called after the last triangle: bounds and view.
void model_close(struct model *model);

// What one entry must be.
struct expected {
	double area; // side²
	double plus[3], minus[3]; // projected, side²
	double place[3]; // Σ area · place, voxels
	bool must; // some triangle reaches into it by more than the margin
	bool may; // or comes as near as the margin
	bool must_either; // of layer 0: must, in this layer or the other, for a line has no side
};

// By bit, of all cells; the caller frees it. Triangles are those of the model, by its vertices as floats.
struct expected *model_expect(const struct model *model, const struct voxel_grid *grid, double margin);

#endif
