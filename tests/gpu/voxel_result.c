#include "tests/gpu/voxel_result.h"

#include "server/worker/devices.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

uint64_t device_bytes, device_budget = 1ull << 32;
struct gl_device *device;

bool voxel_test_begin(void)
{
	const struct gl_device_options options = {.software = true, .bytes = &device_bytes, .budget = &device_budget};
	struct error err;
	if (gl_device_create(&options, &device, &err) == STATUS_OK)
		return true;
	print_message("skipped: %s\n", err.text);
	return false;
}

int voxel_test_end(void)
{
	const int errors = device->errors > 0;
	devices_finish(&(struct devices){.gl = device});
	return errors + (device_bytes != 0);
}

static void *read_all(const struct gl_buffer *b)
{
	void *p = malloc(b->bytes + 4);
	assert_non_null(p);
	if (b->name)
		assert_int_equal(gl_buffer_read(b, device, 0, b->bytes, p, NULL), STATUS_OK);
	return p;
}

const struct plan everything = {.effects = 0xFFFFFFFF, .width = 1, .height = 1};

enum status try_build(struct model *m, uint32_t resolution, bool cube, uint32_t slice_us, struct result *r,
		      struct error *err)
{
	const struct voxel_options options = {.resolution = resolution, .cube = cube};
	struct voxels *v = NULL;
	enum status s = voxels_acquire(&m->scene, device, &everything, &options, &v, err);
	if (s != STATUS_OK)
		return s;
	while (s == STATUS_OK && !voxels_finished(v))
		s = voxels_step(v, NULL, slice_us, err);
	if (s == STATUS_OK) {
		*r = (struct result){.grid = v->grid, .words = voxel_grid_words(&v->grid), .bytes = voxels_bytes(v)};
		r->bits = read_all(&v->words);
		for (int i = 0; i < VOXEL_PARTS; i++)
			r->parts[i] = read_all(&v->parts[i]);
	}
	voxels_release(v);
	return s;
}

struct result build(struct model *m, uint32_t resolution)
{
	struct error err = {0};
	struct result r = {0};
	if (try_build(m, resolution, false, 1000000, &r, &err) != STATUS_OK)
		fail_msg("%s", err.text);
	return r;
}

void result_finish(struct result *r)
{
	free(r->bits);
	for (int i = 0; i < VOXEL_PARTS; i++)
		free(r->parts[i]);
}

bool is_marked(const struct result *r, uint32_t bit)
{
	return r->bits[bit / 32 * 2] >> bit % 32 & 1u;
}

uint32_t entry_of(const struct result *r, uint32_t bit)
{
	return r->bits[bit / 32 * 2 + 1] + (uint32_t)__builtin_popcount(r->bits[bit / 32 * 2] & ((1u << bit % 32) - 1));
}

double real(const struct result *r, int part, uint32_t entry, int c)
{
	float f;
	memcpy(&f, &r->parts[part][4 * entry + (uint32_t)c], sizeof f);
	return (double)f;
}

static double half_to_double(uint32_t h)
{
	const int exponent = (int)(h >> 10 & 31u);
	const double fraction = (h & 1023u) / 1024.0,
		     value = exponent ? ldexp(1 + fraction, exponent - 15) : ldexp(fraction, -14);
	return h & 0x8000u ? -value : value;
}

double projection(const struct result *r, uint32_t entry, int axis, int negative)
{
	return half_to_double(r->parts[3][4 * entry + (uint32_t)axis] >> 16 * negative & 0xFFFFu);
}

double area_of(const struct result *r)
{
	double sum = 0;
	for (uint32_t e = 0; e < r->grid.entries; e++)
		sum += real(r, 2, e, 3);
	return sum;
}

void assert_same(const struct result *a, const struct result *b, bool places)
{
	assert_int_equal(a->grid.entries, b->grid.entries);
	assert_memory_equal(a->bits, b->bits, 8 * a->words);
	for (int i = places ? 0 : 1; i < VOXEL_PARTS; i++)
		assert_memory_equal(a->parts[i], b->parts[i], 16 * (size_t)a->grid.entries);
}

void add_wall(struct model *m, double z, uint32_t material)
{
	model_add_quad(m, (const double[3]){-1, -1, z}, (const double[3]){2, 0, 0}, (const double[3]){0, 2, 0}, material);
}
