// Scenes for the test of radiosity's pictures, and pictures of them from values of elements.
#ifndef CANDIL_TESTS_DISPLAY_ROOM_H
#define CANDIL_TESTS_DISPLAY_ROOM_H

#include "server/worker/image/frame.h"
#include "server/worker/plan/plan.h"
#include "server/worker/technique/radiosity/display.h"
#include "server/worker/technique/radiosity/display_views.h"
#include "tests/gpu/voxel_model.h"

#define SIDE 40u // of a picture, pixels

// A closed box from −1 to 1 seen from inside; or, in the plane z = −2, a trapezoid, a triangle, and a quad that shows its
// back.
enum { ROOM_BOX, ROOM_SHAPES, ROOMS };

// A scene cut into patches, and a camera in it.
struct room {
	struct model model;
	struct elements elements;
	struct plan plan;
	int kind;
	uint32_t rows, slice_us; // how it is drawn
	struct bvh_node node;
	struct leaf_triangle leaves[12];
	struct emitter emitters[12];
};

extern const double room_albedo[3], room_metal[3], room_emission[3];

// Open the device, and close it again. False: there is none. room_end tells how much went wrong.
bool room_begin(void);
int room_end(void);

void room_init(struct room *room, int kind, double edge);
void room_finish(struct room *room);
void room_shine(struct room *room); // let all of the box emit
void room_polish_floor(struct room *room); // make the box's floor, y = −1, a mirror

// Give it surroundings of two texels by one, which `around` keeps.
void room_surround(struct room *room, struct model *around, const struct environment_texel *texels,
		   const struct environment_row *rows);

// Draw it. The frame is the caller's.
struct frame *room_draw(struct room *room, const struct display_options *options, const float *values);

// The place that a pixel's middle sees, in double precision.
void room_place(const struct room *room, uint32_t pixel, double at[3]);

// The same by way of the box's floor, and the cosine there. False: it does not see the floor, or an edge is near.
bool room_mirrored(const struct room *room, uint32_t pixel, double at[3], double *cosine);

#endif
