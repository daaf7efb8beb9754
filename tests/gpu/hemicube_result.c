#include "tests/gpu/hemicube_result.h"

#include <stdlib.h>

#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/hemicube_origin.h"
#include "server/worker/vk/device.h"

struct gl_device *gl;
static struct devices devices;

bool hemicube_test_begin(void)
{
	struct error err;
	if (!model_test_begin())
		return false;
	devices.vk = device;
	if (devices_gl(&devices, &gl, &err) == STATUS_OK)
		return true;
	print_message("skipped: %s\n", err.text);
	return false;
}

int hemicube_test_end(void)
{
	const int errors = (gl->errors > 0) + (device->validation_errors > 0);
	const int left = device->bytes != 0;
	devices_finish(&devices);
	return errors + left;
}

static void make(struct hemicube *h, struct hemicube_result *r, uint32_t batch, struct factors *factors)
{
	for (uint32_t at = 0; at < r->count;) {
		uint32_t n = hemicube_batch(h, 1e12);
		n = batch > 0 && n > batch ? batch : n;
		n = n > r->count - at ? r->count - at : n;
		uint32_t *list = malloc(n * sizeof *list);
		assert_non_null(list);
		for (uint32_t i = 0; i < n; i++)
			list[i] = r->first + at + i;
		struct error err = {0};
		if (hemicube_rows(h, list, n, factors, &err) != STATUS_OK)
			fail_msg("%s", err.text);
		free(list);
		at += n;
	}
}

static void read_rows(struct hemicube_result *r, const struct factors *factors)
{
	for (uint32_t i = 0; i < r->count; i++) {
		const struct factors_row *row = &factors->rows[r->first + i];
		uint32_t *columns;
		float *values;
		assert_true(row->block != NONE);
		assert_int_equal(factors_read_row(factors, r->first + i, &columns, &values, NULL), STATUS_OK);
		for (uint32_t k = 0; k < row->count; k++)
			r->values[(size_t)i * r->side + columns[k]] = values[k];
		r->escaped[i] = row->escaped;
		r->cut[i] = row->cut;
		free(columns);
		free(values);
	}
}

struct hemicube_result hemicube_result_make(struct patch_model *m, const struct hemicube_options *options, uint32_t first,
					    uint32_t count, uint32_t batch)
{
	return hemicube_result_of(m, NULL, options, first, count, batch);
}

struct hemicube_result hemicube_result_of(struct patch_model *m, const struct radiosity_surface *surfaces,
					  const struct hemicube_options *options, uint32_t first, uint32_t count,
					  uint32_t batch)
{
	struct hemicube_result r = {.first = first, .count = count, .side = m->elements.count};
	struct factors factors;
	struct hemicube *h;
	struct error err = {0};
	r.values = calloc((size_t)count * r.side, sizeof *r.values);
	r.escaped = calloc(count, sizeof *r.escaped);
	r.cut = calloc(count, sizeof *r.cut);
	assert_true(r.values && r.escaped && r.cut);
	assert_int_equal(factors_init(&factors, device, r.side, NULL), STATUS_OK);
	const uint64_t before = device->bytes;
	if (hemicube_create(gl, &m->scene, &everything, &m->elements, options, &h, &err) != STATUS_OK)
		fail_msg("%s", err.text);
	if (surfaces)
		assert_int_equal(hemicube_reflect(h, surfaces, &err), STATUS_OK);
	const struct patches *p = &m->elements.patches;
	assert_true(device->bytes - before <= hemicube_bytes(m->count, p->count, options));
	make(h, &r, batch, &factors);
	hemicube_destroy(h);
	read_rows(&r, &factors);
	factors_finish(&factors);
	return r;
}

void hemicube_result_finish(struct hemicube_result *r)
{
	free(r->values);
	free(r->escaped);
	free(r->cut);
}

double hemicube_result_sum(const struct hemicube_result *r, uint32_t row)
{
	double sum = (double)r->escaped[row - r->first] + (double)r->cut[row - r->first];
	for (uint32_t j = 0; j < r->side; j++)
		sum += factor_at(r, row, j);
	return sum;
}

double mean_from_origins(const struct patch_model *m, uint32_t element, uint32_t origins, const struct form_polygon *polygon,
			 visible_part *visible)
{
	double sum = 0;
	for (uint32_t i = 0; i < origins; i++) {
		struct hemicube_origin o;
		struct form_polygon part = *polygon;
		hemicube_origin_get(&m->elements, element, i, origins, &o);
		if (visible)
			visible(o.at, &part);
		sum += fmax(form_factor_at(o.at, o.z, &part), 0) / origins;
	}
	return sum;
}
