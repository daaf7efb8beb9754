// A mesh of a test as a resident scene with a tree, cut into elements, all on a device: what passes of radiosity need.
#ifndef CANDIL_TESTS_TRACED_MESH_H
#define CANDIL_TESTS_TRACED_MESH_H

#include "server/loader/bvh.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/element_buffers.h"
#include "tests/unit/patch_mesh.h"

#define TRACED_MATERIALS 8u

struct traced_mesh {
	struct device *device;
	struct material materials[TRACED_MATERIALS]; // grey, without textures
	struct blob_header header;
	struct bvh bvh;
	struct leaf_triangle *leaves;
	struct resident_scene scene;
	struct elements elements;
	struct element_buffers buffers; // surfaces are zero
};

// `edge`: of patches, in metres. The mesh must outlive it. Fails the test where something fails.
void traced_mesh_init(struct traced_mesh *traced, struct device *device, const struct mesh *mesh, double edge);
void traced_mesh_finish(struct traced_mesh *traced);

// Give every element of a material this mirror reflectance, grey.
void traced_mesh_polish(struct traced_mesh *traced, uint32_t material, float mirror);

// A mesh, with every corner turned about an axis by an angle, scaled and shifted.
void mesh_place(struct mesh *mesh, const double axis[3], double angle, double scale, double shift);

#endif
