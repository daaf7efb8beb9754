// Files of patches and of form factors: what is written is read back bit for bit, by this test and by the loader, whatever
// the slices, and no more is written than a file may have.
#include "tests/unit/element_samples.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/loader/patch_matrix.h"
#include "server/loader/patch_ply.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/patch_file.h"

#define ENTRIES_MOST 4096u
#define PLENTY (1u << 30)

// A solution without a device: its elements are real, what is found about them is drawn.
struct sample {
	struct mesh mesh;
	struct blob_header blob;
	struct resident_scene scene;
	struct factor_build build;
	struct factors_block block;
	struct solution solution;
	uint32_t columns[ENTRIES_MOST];
	float values[ENTRIES_MOST];
	uint64_t reached; // entries of rows that light reaches
};

static float any(uint32_t *seed)
{
	return (float)(noise(seed) * pow(10, -12 * noise(seed)));
}

// Some are at the ends of what floats hold.
static float any_value(uint32_t *seed)
{
	static const float ends[] = {0, 1, 1 - 0x1p-24f, 0x1p-149f, 0x1p-126f - 0x1p-149f};
	const double choice = 12 * noise(seed);
	return choice < 5 ? ends[(int)choice] : any(seed);
}

static void draw_rows(struct sample *s)
{
	struct factors *f = &s->build.factors;
	const uint32_t count = s->build.elements.count;
	*f = (struct factors){.side = count, .blocks = &s->block, .block_count = 1};
	f->rows = calloc(count, sizeof *f->rows);
	s->solution.reached = calloc(count, 1);
	s->reached = 0;
	for (uint32_t i = 0, at = 0; i < count; i++) {
		struct factors_row *row = &f->rows[i];
		row->block = i % 5 == 4 ? NONE : 0;
		row->first = at;
		row->count = i % 5 == 4 ? 0 : i % 4;
		row->escaped = any(&s->mesh.seed);
		row->cut = any(&s->mesh.seed);
		s->solution.reached[i] = i % 5 != 4 && i % 7 != 3;
		for (uint32_t k = 0; k < row->count; k++, at++) {
			s->columns[at] = k * (count / 4) + i % (count / 4);
			s->values[at] = any_value(&s->mesh.seed);
		}
		s->reached += s->solution.reached[i] ? row->count : 0;
		assert_true(at + 4 < ENTRIES_MOST);
	}
	s->block = (struct factors_block){.columns.map = s->columns, .values.map = s->values, .entries = ENTRIES_MOST};
}

static void sample_init(struct sample *s, uint32_t kind)
{
	memset(s, 0, sizeof *s);
	element_mesh(&s->mesh, kind);
	assert_int_equal(elements_init(&s->build.elements, &s->mesh.view, &(struct patch_options){.edge = 0.6}, NULL),
			 STATUS_OK);
	s->blob = (struct blob_header){.origin = {kind == 3 ? 1 << 20 : 0, -3, 0}, .hash = {0x123, 0xabc}};
	s->scene.view = s->mesh.view;
	s->scene.view.blob = &s->blob;
	draw_rows(s);
	const uint32_t count = s->build.elements.count;
	s->solution.factors = &s->build;
	s->solution.made_of = calloc(count, sizeof *s->solution.made_of);
	s->solution.irradiance = calloc(3 * (size_t)count, sizeof *s->solution.irradiance);
	s->solution.direct = calloc(3 * (size_t)count, sizeof *s->solution.direct);
	s->solution.lamps = kind % 2;
	for (uint32_t i = 0; i < 3 * count; i++) {
		s->solution.made_of[i / 3].emission[i % 3] = any(&s->mesh.seed);
		s->solution.made_of[i / 3].albedo[i % 3] = any_value(&s->mesh.seed);
		s->solution.irradiance[i] = any_value(&s->mesh.seed);
		s->solution.direct[i] = any_value(&s->mesh.seed);
	}
}

static void sample_finish(struct sample *s)
{
	elements_finish(&s->build.elements);
	free(s->build.factors.rows);
	free(s->solution.reached);
	free(s->solution.made_of);
	free(s->solution.irradiance);
	free(s->solution.direct);
}

// Write a file. Its bytes, which are the caller's, and a zero behind them.
static char *written(const struct sample *s, candil_Format format, uint32_t budget_us, uint64_t *bytes)
{
	struct patch_file *f;
	struct error err;
	int fd;
	assert_int_equal(patch_file_create(&s->solution, &s->scene, format, PLENTY, &f, &err), STATUS_OK);
	assert_int_equal(patch_file_take(f, &fd, bytes, &err), STATUS_INTERNAL);
	for (double done = 0; !patch_file_finished(f);) {
		assert_int_equal(patch_file_step(f, budget_us, &err), STATUS_OK);
		assert_true(patch_file_fraction(f) >= done && patch_file_fraction(f) <= 1);
		done = patch_file_fraction(f);
	}
	assert_int_equal(patch_file_take(f, &fd, bytes, &err), STATUS_OK);
	char *data = calloc(*bytes + 1, 1);
	assert_int_equal(pread(fd, data, *bytes + 1, 0), *bytes);
	assert_true(write(fd, "x", 1) < 0);
	close(fd);
	assert_int_equal(patch_file_take(f, &fd, bytes, &err), STATUS_INTERNAL);
	patch_file_destroy(f);
	return data;
}

static char *twice(const struct sample *s, candil_Format format, uint64_t *bytes)
{
	uint64_t again_bytes;
	char *data = written(s, format, UINT32_MAX, bytes), *again = written(s, format, 0, &again_bytes);
	assert_true(*bytes == again_bytes && memcmp(data, again, *bytes) == 0);
	free(again);
	return data;
}

static const char *take(const char *at, void *value, size_t bytes)
{
	memcpy(value, at, bytes);
	return at + bytes;
}

static const char *check_corners(const struct sample *s, const char *at)
{
	const struct elements *e = &s->build.elements;
	for (uint32_t i = 0; i < e->patches.count; i++) {
		struct patch p;
		patches_get(&e->patches, i, &p);
		for (uint32_t k = 0; k < p.shape.corners; k++)
			for (uint32_t c = 0; c < 3; c++) {
				double x;
				at = take(at, &x, sizeof x);
				const double own = (double)e->shapes[i].corner[3 * k + c], origin = s->blob.origin[c];
				assert_true(x == origin + own &&
					    (origin != 0 || (float)x == e->shapes[i].corner[3 * k + c]));
			}
	}
	return at;
}

static const char *check_face(const struct sample *s, uint32_t element, uint32_t first, const char *at)
{
	const struct elements *e = &s->build.elements;
	const struct radiosity_surface *of = &s->solution.made_of[element];
	const uint32_t patch = element % e->patches.count;
	uint8_t corners, side, straight, reached;
	uint32_t corner, number, material;
	float area, b[3], m[3], d[3], rho[3], h[3], escaped, cut;
	struct patch p;
	patches_get(&e->patches, patch, &p);
	at = take(at, &corners, 1);
	assert_int_equal(corners, p.shape.corners);
	for (uint32_t k = 0; k < corners; k++) {
		at = take(at, &corner, sizeof corner);
		assert_int_equal(corner, first + (element == patch ? k : corners - 1 - k));
	}
	at = take(take(take(at, &number, 4), &side, 1), &material, 4);
	assert_true(number == patch && side == (element != patch) && material == p.material);
	at = take(take(take(take(take(at, &area, 4), b, 12), m, 12), d, 12), rho, 12);
	at = take(take(take(take(take(at, &straight, 1), &reached, 1), &escaped, 4), &cut, 4), h, 12);
	assert_memory_equal(h, &s->solution.irradiance[3 * element], sizeof h);
	assert_true(straight == s->solution.lamps && !memcmp(d, &s->solution.direct[3 * element], sizeof d));
	const struct factors_row *row = &s->build.factors.rows[element];
	assert_true(area == e->shapes[patch].area && reached == s->solution.reached[element]);
	assert_true(escaped == (reached ? row->escaped : 0) && cut == (reached ? row->cut : 0));
	for (uint32_t c = 0; c < 3; c++) {
		check_close("exitance", (double)m[c], 3.14159265358979 * (double)of->emission[c], 1e-6);
		assert_true(rho[c] == of->albedo[c]);
		check_close("radiosity", (double)b[c],
			    (double)m[c] + (double)rho[c] * (double)s->solution.irradiance[3 * element + c], 1e-6);
	}
	return at;
}

// The import of a file, which import_finish frees.
static void loaded(struct import *im,
		   enum status (*read)(struct import *, const char *, const struct file_bytes *, struct error *), char *data,
		   uint64_t bytes)
{
	static struct files files;
	static candil_SceneInfo info;
	struct error err = {0};
	import_init(im, &files, &info);
	const struct file_bytes file = {(uint8_t *)data, bytes};
	if (read(im, "file", &file, &err) != STATUS_OK)
		fail_msg("%s", err.text);
}

static void check_loaded_face(const struct sample *s, const struct imported_element *loaded, uint32_t element)
{
	const struct elements *e = &s->build.elements;
	const struct solution *v = &s->solution;
	const struct factors_row *row = &s->build.factors.rows[element];
	const uint32_t patch = element % e->patches.count, side = element != patch;
	struct patch p;
	patches_get(&e->patches, patch, &p);
	assert_true(loaded->patch == patch && loaded->side == side && loaded->material == p.material);
	assert_true(loaded->corners == p.shape.corners && loaded->area == e->shapes[patch].area);
	for (uint32_t k = 0; k < p.shape.corners; k++)
		for (uint32_t c = 0; c < 3; c++)
			assert_true(loaded->corner[side ? p.shape.corners - 1 - k : k][c] ==
				    s->blob.origin[c] + (double)e->shapes[patch].corner[3 * k + c]);
	assert_true(loaded->straight == v->lamps && loaded->reached == v->reached[element]);
	assert_true(loaded->escaped == (loaded->reached ? row->escaped : 0) &&
		    loaded->cut == (loaded->reached ? row->cut : 0));
	assert_memory_equal(loaded->h, &v->irradiance[3 * element], sizeof loaded->h);
	assert_memory_equal(loaded->d, &v->direct[3 * element], sizeof loaded->d);
	assert_memory_equal(loaded->rho, v->made_of[element].albedo, sizeof loaded->rho);
	for (uint32_t c = 0; c < 3; c++) {
		const float m = (float)3.14159265358979323846 * v->made_of[element].emission[c];
		assert_true(loaded->m[c] == m && loaded->b[c] == m + loaded->rho[c] * loaded->h[c]);
	}
}

static void the_loader_has_the_same_patches(void **state)
{
	static struct sample s;
	uint64_t bytes;
	(void)state;
	for (uint32_t kind = 0; kind < ELEMENT_MESHES; kind++) {
		struct import im;
		sample_init(&s, kind);
		char *data = written(&s, candil_Format_FORMAT_PLY, UINT32_MAX, &bytes);
		loaded(&im, patch_ply_import, data, bytes);
		assert_int_equal(im.element_count, s.build.elements.count);
		for (uint32_t i = 0; i < im.element_count; i++)
			check_loaded_face(&s, &im.elements[i], i);
		import_finish(&im);
		free(data);
		sample_finish(&s);
	}
}

static void the_loader_has_the_same_factors(void **state)
{
	static struct sample s;
	uint64_t bytes;
	struct import im;
	(void)state;
	sample_init(&s, 2);
	char *data = written(&s, candil_Format_FORMAT_MTX, UINT32_MAX, &bytes);
	loaded(&im, patch_matrix_import, data, bytes);
	assert_true(im.row_count == s.build.elements.count && im.factor_count == s.reached);
	for (uint32_t i = 0; i < im.row_count; i++) {
		const struct factors_row *row = &s.build.factors.rows[i];
		assert_int_equal(im.rows[i].count, s.solution.reached[i] ? row->count : 0);
		for (uint32_t k = 0; k < im.rows[i].count; k++) {
			const struct imported_factor *f = &im.factors[im.rows[i].first + k];
			assert_int_equal(f->column, s.columns[row->first + k]);
			assert_memory_equal(&f->value, &s.values[row->first + k], sizeof f->value);
		}
	}
	import_finish(&im);
	free(data);
	sample_finish(&s);
}

static void patches_are_read_back(void **state)
{
	static struct sample s;
	(void)state;
	for (uint32_t kind = 0; kind < ELEMENT_MESHES; kind++) {
		uint64_t bytes;
		unsigned vertices, faces;
		sample_init(&s, kind);
		char *data = twice(&s, candil_Format_FORMAT_PLY, &bytes);
		const char *count = strstr(data, "element vertex "), *end = strstr(data, "end_header\n");
		assert_true(strncmp(data, "ply\nformat binary_little_endian 1.0\n", 36) == 0 && count && end);
		assert_int_equal(sscanf(count, "element vertex %u", &vertices), 1);
		assert_int_equal(sscanf(strstr(data, "element face "), "element face %u", &faces), 1);
		assert_int_equal(faces, s.build.elements.count);
		const char *at = check_corners(&s, end + strlen("end_header\n"));
		assert_true(at - (end + strlen("end_header\n")) == (ptrdiff_t)(vertices * 24));
		uint32_t first = 0;
		for (uint32_t i = 0; i < faces; i++) {
			if (i == faces / 2) {
				assert_int_equal(first, vertices);
				first = 0;
			}
			const uint8_t corners = (uint8_t)*at;
			at = check_face(&s, i, first, at);
			first += corners;
		}
		assert_true(at == data + bytes);
		free(data);
		sample_finish(&s);
	}
}

static void factors_are_read_back(void **state)
{
	static struct sample s;
	uint64_t bytes;
	uint32_t side[2];
	unsigned long long entries;
	int length;
	(void)state;
	sample_init(&s, 2);
	char *data = twice(&s, candil_Format_FORMAT_MTX, &bytes);
	const char *at = data;
	assert_true(strncmp(data, "%%MatrixMarket matrix coordinate real general\n", 46) == 0);
	while (*at == '%')
		at = strchr(at, '\n') + 1;
	assert_int_equal(sscanf(at, "%u %u %llu\n%n", &side[0], &side[1], &entries, &length), 3);
	assert_true(side[0] == s.build.elements.count && side[1] == side[0] && entries == s.reached && entries > 50);
	at += length;
	for (uint32_t i = 0; i < side[0]; i++)
		for (uint32_t k = 0; s.solution.reached[i] && k < s.build.factors.rows[i].count; k++, at += length) {
			const uint32_t entry = s.build.factors.rows[i].first + k;
			uint32_t row, column;
			float value;
			assert_int_equal(sscanf(at, "%u %u %f\n%n", &row, &column, &value, &length), 3);
			assert_true(row == i + 1 && column == s.columns[entry] + 1);
			assert_memory_equal(&value, &s.values[entry], sizeof value);
		}
	assert_true(at == data + bytes);
	free(data);
	sample_finish(&s);
}

static void a_file_has_no_more_than_it_may(void **state)
{
	static struct sample s;
	struct patch_file *f;
	struct error err;
	uint64_t bytes;
	(void)state;
	sample_init(&s, 0);
	free(written(&s, candil_Format_FORMAT_MTX, UINT32_MAX, &bytes));
	// As many as it has will do, and one less will not, which may show at the end alone.
	assert_int_equal(patch_file_create(&s.solution, &s.scene, candil_Format_FORMAT_MTX, bytes, &f, &err), STATUS_OK);
	assert_int_equal(patch_file_step(f, UINT32_MAX, &err), STATUS_OK);
	patch_file_destroy(f);
	assert_int_equal(patch_file_create(&s.solution, &s.scene, candil_Format_FORMAT_MTX, bytes - 1, &f, &err), STATUS_OK);
	assert_int_equal(patch_file_step(f, UINT32_MAX, &err), STATUS_LIMIT);
	assert_non_null(strstr(err.text, "radiosity.patches"));
	patch_file_destroy(f);
	const uint64_t least = 6 * s.reached;
	assert_int_equal(patch_file_create(&s.solution, &s.scene, candil_Format_FORMAT_MTX, least - 1, &f, &err),
			 STATUS_LIMIT);
	assert_int_equal(patch_file_create(&s.solution, &s.scene, candil_Format_FORMAT_PLY, 1000, &f, &err), STATUS_LIMIT);
	// Numbers of entries that no memory holds.
	s.build.factors.rows[0].count = UINT32_MAX;
	assert_int_equal(
	    patch_file_create(&s.solution, &s.scene, candil_Format_FORMAT_MTX, LIMIT_PATCH_FILE_BYTES, &f, &err),
	    STATUS_LIMIT);
	sample_finish(&s);
}

static void what_has_no_patches_has_files(void **state)
{
	static struct sample s;
	uint64_t bytes;
	(void)state;
	start(&s.mesh);
	memset(&s.build, 0, sizeof s.build);
	s.scene.view.blob = &s.blob;
	s.solution = (struct solution){.factors = &s.build};
	char *data = twice(&s, candil_Format_FORMAT_PLY, &bytes);
	assert_non_null(strstr(data, "element face 0\n"));
	free(data);
	data = twice(&s, candil_Format_FORMAT_MTX, &bytes);
	assert_string_equal(data + bytes - 6, "0 0 0\n");
	free(data);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(patches_are_read_back),           cmocka_unit_test(factors_are_read_back),
	    cmocka_unit_test(the_loader_has_the_same_patches), cmocka_unit_test(the_loader_has_the_same_factors),
	    cmocka_unit_test(a_file_has_no_more_than_it_may),  cmocka_unit_test(what_has_no_patches_has_files),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
