#include "tests/gpu/display_room.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/base/angle.h"
#include "server/base/vec3.h"
#include "server/worker/devices.h"
#include "server/worker/gl/settle.h"
#include "server/worker/trace/trace.h"

#define EFFECTS \
	(1u << candil_Effect_EFFECT_TEXTURES | 1u << candil_Effect_EFFECT_EMITTERS | 1u << candil_Effect_EFFECT_LIGHTS | \
	 1u << candil_Effect_EFFECT_ENVIRONMENT | 1u << candil_Effect_EFFECT_UNLIT | 1u << candil_Effect_EFFECT_GLOSSY)

const double room_albedo[3] = {0.5, 0.25, 0.75}, room_metal[3] = {0.875, 0.75, 0.5}, room_emission[3] = {1, 2, 0.5};

static uint64_t device_bytes, device_budget = 1ull << 32;
static struct devices devices;

bool room_begin(void)
{
	const struct gl_device_options options = {.software = true, .bytes = &device_bytes, .budget = &device_budget};
	struct error err;
	if (gl_device_create(&options, &devices.gl, &err) == STATUS_OK && gl_settle_prepare(devices.gl, &err) == STATUS_OK)
		return true;
	print_message("skipped: %s\n", err.text);
	return false;
}

int room_end(void)
{
	const int errors = devices.gl->errors > 0;
	devices_finish(&devices);
	return errors + (device_bytes != 0);
}

// ---- scenes
// ---------------------------------------------------------------------------------------------------------------

static void add_box(struct model *m)
{
	// Floor first; each looks inwards.
	static const double walls[6][3][3] = {{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}}, {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}},
					      {{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}}, {{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}},
					      {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}}, {{1, -1, -1}, {0, 0, 2}, {0, 2, 0}}};
	for (int i = 0; i < 6; i++)
		model_add_quad(m, walls[i][0], walls[i][1], walls[i][2], i == 0);
}

static void add_shapes(struct model *m)
{
	static const double p[4][3] = {{-1.5, -0.5, -2}, {1.5, -1.5, -2}, {1, 1.5, -2}, {-0.5, 1, -2}};
	static const double t[3][3] = {{-1.9, 0, -2}, {-0.7, 1.1, -2}, {-1.8, 1.9, -2}};
	static const double q[3][3] = {{-1.9, -1.9, -2}, {0, 0.8, 0}, {1.2, 0, 0}};
	model_add(m, p[0], p[1], p[2], 0);
	model_add(m, p[0], p[2], p[3], 0);
	model_add(m, t[0], t[1], t[2], 0);
	model_add_quad(m, q[0], q[1], q[2], 0);
}

// All triangles in one leaf.
static void add_tree(struct room *r)
{
	struct blob_view *v = &r->model.scene.view;
	assert_true(r->model.triangle_count <= sizeof r->leaves / sizeof *r->leaves);
	r->node.count0 = r->model.triangle_count;
	for (int c = 0; c < 3; c++) {
		r->node.min0[c] = v->bounds_min[c];
		r->node.max0[c] = v->bounds_max[c];
		r->node.min1[c] = r->node.max1[c] = INFINITY;
	}
	for (uint32_t i = 0; i < r->model.triangle_count; i++) {
		const struct triangle *t = &r->model.triangles[i];
		struct leaf_triangle *l = &r->leaves[i];
		l->id = i;
		l->material = t->material;
		memcpy(l->v0, r->model.vertices[t->vertex[0]].position, sizeof l->v0);
		memcpy(l->v1, r->model.vertices[t->vertex[1]].position, sizeof l->v1);
		memcpy(l->v2, r->model.vertices[t->vertex[2]].position, sizeof l->v2);
	}
	v->sections[BLOB_NODES] = &r->node;
	v->sections[BLOB_LEAF_TRIANGLES] = r->leaves;
	v->counts[BLOB_NODES] = 1;
	v->counts[BLOB_LEAF_TRIANGLES] = r->model.triangle_count;
}

void room_init(struct room *r, int kind, double edge)
{
	memset(r, 0, sizeof *r);
	model_init(&r->model);
	if (kind == ROOM_BOX)
		add_box(&r->model);
	else
		add_shapes(&r->model);
	model_close(&r->model);
	add_tree(r);
	for (int i = 0; i < 2; i++)
		for (int c = 0; c < 3; c++)
			r->model.materials[i].albedo[c] = (float)room_albedo[c];
	r->kind = kind;
	r->slice_us = 1000000;
	r->plan = (struct plan){.width = SIDE, .height = SIDE, .samples = 1, .effects = EFFECTS};
	r->plan.camera = (struct plan_camera){.eye = {0.13, 0.07, 0.21}, .forward = {0.1, -0.2, -1}, .right = {1, 0, 0.1}};
	struct plan_camera *c = &r->plan.camera;
	vec3_normalize(c->forward);
	vec3_normalize(c->right);
	vec3_cross(c->right, c->forward, c->up);
	struct error err = {0};
	const struct patch_options options = {.edge = edge};
	if (elements_init(&r->elements, &r->model.scene.view, &options, &err) != STATUS_OK)
		fail_msg("%s", err.text);
}

void room_finish(struct room *r)
{
	elements_finish(&r->elements);
	model_finish(&r->model);
}

void room_polish_floor(struct room *r)
{
	struct material *m = &r->model.materials[1];
	m->metallic = 1;
	m->roughness = 0.01f;
	for (int c = 0; c < 3; c++)
		m->albedo[c] = (float)room_metal[c];
}

void room_shine(struct room *r)
{
	struct blob_view *v = &r->model.scene.view;
	const uint32_t n = r->model.triangle_count;
	for (int i = 0; i < 2; i++) {
		for (int c = 0; c < 3; c++)
			r->model.materials[i].emission[c] = (float)room_emission[c];
		r->model.materials[i].power_density = (float)PI;
	}
	for (uint32_t i = 0; i < n; i++)
		r->emitters[i] = (struct emitter){.triangle = i, .keep = 1, .alias = i, .pmf = 1.0f / (float)n};
	v->sections[BLOB_EMITTERS] = r->emitters;
	v->counts[BLOB_EMITTERS] = n;
	v->emitter_power = (float)(24 * PI);
}

void room_surround(struct room *r, struct model *around, const struct environment_texel *texels,
		   const struct environment_row *rows)
{
	model_init(around);
	model_close(around);
	around->header.environment_width = 2;
	around->header.environment_height = 1;
	around->scene.view.sections[BLOB_ENVIRONMENT] = texels;
	around->scene.view.sections[BLOB_ENVIRONMENT_ROWS] = rows;
	around->scene.view.counts[BLOB_ENVIRONMENT] = around->scene.view.counts[BLOB_ENVIRONMENT_ROWS] = 2;
	r->plan.environment =
	    (struct plan_environment){.scene = &around->scene, .width = 2, .height = 1, .scale = 1, .power = 1};
}

// ---- pictures
// -------------------------------------------------------------------------------------------------------------

static enum status draw(struct room *r, const struct display_options *options, const struct display_field *field,
			struct frame **frame, struct error *err)
{
	const struct plan shown = display_plan(&r->plan);
	struct display display;
	struct deferred *deferred = NULL;
	enum status s = display_init(&display, &devices, &r->model.scene, &r->plan, options, field, err);
	if (s != STATUS_OK)
		return s;
	s = deferred_create(&devices, &r->model.scene, &shown, r->rows, display_traces(options) ? TRACE_BINDINGS : 0,
			    display.passes, display.pass_count, &deferred, err);
	while (s == STATUS_OK && !display_ready(&display))
		s = display_step(&display, deferred_timer(deferred), r->slice_us, err);
	for (struct step_result result = STEP_RESULT_NOTHING; s == STATUS_OK && !result.finished;)
		s = deferred_step(deferred, r->slice_us, &result, err);
	if (s == STATUS_OK)
		s = deferred_read(deferred, frame, err);
	deferred_destroy(deferred);
	display_finish(&display);
	return s;
}

struct frame *room_draw(struct room *r, const struct display_options *options, const float *values)
{
	struct display_options o = *options;
	struct display_field field;
	struct frame *frame = NULL;
	struct error err = {0};
	o.light.rows = r->rows;
	if (display_field_init(&field, devices.gl, &r->elements, values, o.corners, &err) != STATUS_OK ||
	    draw(r, &o, &field, &frame, &err) != STATUS_OK)
		fail_msg("%s", err.text);
	display_field_finish(&field);
	assert_int_equal(frame->non_finite_samples, 0);
	return frame;
}

// ---- rays in double precision
// -----------------------------------------------------------------------------------------------

static void direction_of(const struct room *r, uint32_t pixel, double w[3])
{
	const struct plan_camera *c = &r->plan.camera;
	const double x = 2 * (pixel % SIDE + 0.5) / SIDE - 1, y = 1 - 2 * ((double)(pixel / SIDE) + 0.5) / SIDE;
	for (int i = 0; i < 3; i++)
		w[i] = c->forward[i] + x * c->right[i] + y * c->up[i];
	vec3_normalize(w);
}

// From a place within the box to its wall, whose axis is returned.
static int to_wall(const double from[3], const double w[3], double at[3])
{
	double t = INFINITY;
	int axis = 0;
	for (int i = 0; i < 3; i++) {
		const double d = ((w[i] > 0 ? 1 : -1) - from[i]) / w[i];
		if (w[i] != 0 && d > 1e-9 && d < t) {
			t = d;
			axis = i;
		}
	}
	for (int i = 0; i < 3; i++)
		at[i] = from[i] + t * w[i];
	return axis;
}

void room_place(const struct room *r, uint32_t pixel, double at[3])
{
	const double *eye = r->plan.camera.eye;
	double w[3];
	direction_of(r, pixel, w);
	if (r->kind == ROOM_BOX)
		to_wall(eye, w, at);
	else
		for (int i = 0; i < 3; i++)
			at[i] = eye[i] + (-2 - eye[2]) / w[2] * w[i];
}

static bool near_edge(const double at[3])
{
	int walls = 0;
	for (int i = 0; i < 3; i++)
		walls += fabs(at[i]) > 0.999;
	return walls != 1;
}

bool room_mirrored(const struct room *r, uint32_t pixel, double at[3], double *cosine)
{
	double w[3], floor[3];
	direction_of(r, pixel, w);
	if (to_wall(r->plan.camera.eye, w, floor) != 1 || w[1] > 0 || near_edge(floor))
		return false;
	*cosine = -w[1];
	w[1] = -w[1];
	to_wall(floor, w, at);
	return !near_edge(at);
}
