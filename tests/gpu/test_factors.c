// The matrix of form factors holds exactly what was put into it: dense rows from the device, by the host and by the shader,
// rows from the host, rows that replace others, in blocks that overflow; and it says what is no row of it.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/vk/device.h"

#define SKIPPED 77
#define UNIT 0x1p30

static struct device *device;
static struct error err;

// ---- what the matrix should be
// --------------------------------------------------------------------------------------------

struct model {
	uint32_t side;
	uint32_t *words; // by row and column
	struct factors_put *rows; // by row
};

static uint32_t seed;

static uint32_t draw(void)
{
	seed = seed * 747796405u + 2891336453u;
	const uint32_t word = ((seed >> ((seed >> 28) + 4)) ^ seed) * 277803737u;
	return word >> 22 ^ word;
}

// Row i of a model: every seventh is empty, every eleventh full, the others have about one entry in `sparse`.
static void fill_row(struct model *m, uint32_t i, uint32_t sparse)
{
	for (uint32_t j = 0; j < m->side; j++) {
		const bool there = i % 7 != 3 && (i % 11 == 5 || draw() % sparse == 0);
		m->words[(size_t)i * m->side + j] = there ? draw() | 1u : 0;
	}
	m->rows[i] = (struct factors_put){
	    .element = i, .escaped = (float)(draw() % 1000) / 1000.0f, .cut = (float)(draw() % 100) / 1000.0f};
}

static struct model model_make(uint32_t side, uint32_t sparse)
{
	struct model m = {.side = side};
	m.words = malloc((size_t)side * side * sizeof *m.words);
	m.rows = malloc(side * sizeof *m.rows);
	assert_true(m.words && m.rows);
	seed = side;
	for (uint32_t i = 0; i < side; i++)
		fill_row(&m, i, sparse);
	return m;
}

static void model_free(struct model *m)
{
	free(m->words);
	free(m->rows);
}

static void check_row(const struct factors *f, const struct model *m, uint32_t i)
{
	uint32_t *columns, n = 0;
	float *values;
	assert_int_not_equal(f->rows[i].block, NONE);
	assert_int_equal(factors_read_row(f, i, &columns, &values, &err), STATUS_OK);
	for (uint32_t j = 0; j < m->side; j++) {
		const uint32_t word = m->words[(size_t)i * m->side + j];
		if (word == 0)
			continue;
		const float expected = (float)word * (float)(1 / UNIT);
		assert_true(n < f->rows[i].count);
		assert_int_equal(columns[n], j);
		assert_memory_equal(&values[n], &expected, sizeof expected);
		n++;
	}
	assert_int_equal(f->rows[i].count, n);
	assert_true(f->rows[i].escaped == m->rows[i].escaped && f->rows[i].cut == m->rows[i].cut);
	free(columns);
	free(values);
}

static void check_entries(const struct factors *f)
{
	uint64_t sum = 0, room = 0, used = 0;
	for (uint32_t i = 0; i < f->side; i++)
		if (f->rows[i].block != NONE) {
			const struct factors_row *r = &f->rows[i];
			sum += r->count;
			room += (r->count + FACTORS_ALIGN - 1) / FACTORS_ALIGN * FACTORS_ALIGN;
			assert_int_equal(r->first % FACTORS_ALIGN, 0);
			assert_true(r->block < f->block_count);
			assert_true(r->first + r->count <= f->blocks[r->block].entries);
		}
	for (uint32_t b = 0; b < f->block_count; b++) {
		used += f->blocks[b].entries;
		assert_true(f->blocks[b].columns.bytes <= (uint64_t)f->block_entries * 4);
	}
	assert_int_equal(f->entries, sum);
	assert_int_equal(f->holes, used - room);
}

// What is behind a row, up to the next multiple of four.
static void check_padding(const struct factors *f, uint32_t i)
{
	const struct factors_row *r = &f->rows[i];
	for (uint32_t k = r->first + r->count; k % FACTORS_ALIGN != 0; k++) {
		uint32_t pair[2];
		assert_int_equal(buffer_read(&f->blocks[r->block].columns, device, k * 4ull, 4, &pair[0], &err), STATUS_OK);
		assert_int_equal(buffer_read(&f->blocks[r->block].values, device, k * 4ull, 4, &pair[1], &err), STATUS_OK);
		assert_int_equal(pair[0] | pair[1], 0);
	}
}

// ---- dense rows
// -----------------------------------------------------------------------------------------------------------

static void put_all(struct factors *f, const struct model *m, uint32_t batch)
{
	struct buffer dense;
	const size_t row = (size_t)m->side * sizeof *m->words;
	for (uint32_t first = 0; first < m->side; first += batch) {
		const uint32_t count = m->side - first < batch ? m->side - first : batch;
		assert_int_equal(buffer_init_with(&dense, device, m->words + (size_t)first * m->side, count * row + 4, &err),
				 STATUS_OK);
		assert_int_equal(factors_put_dense(f, &dense, UNIT, m->rows + first, count, &err), STATUS_OK);
		uint32_t *left = malloc(count * row);
		assert_non_null(left);
		assert_int_equal(buffer_read(&dense, device, 0, count * row, left, &err), STATUS_OK);
		for (size_t k = 0; k < (size_t)count * m->side; k++)
			assert_int_equal(left[k], 0);
		free(left);
		buffer_finish(&dense, device);
	}
}

static void check_dense(uint32_t side, uint32_t sparse, uint32_t block_entries, uint32_t batch, bool on_host)
{
	struct model m = model_make(side, sparse);
	struct factors f;
	m.words = realloc(m.words, ((size_t)side * side + 1) * sizeof *m.words); // the buffer is a word longer
	assert_non_null(m.words);
	m.words[(size_t)side * side] = 0;
	assert_int_equal(factors_init(&f, device, side, &err), STATUS_OK);
	f.packs_on_host = f.packs_on_host && on_host;
	if (block_entries)
		f.block_entries = block_entries;
	put_all(&f, &m, batch);
	check_entries(&f);
	for (uint32_t i = 0; i < side; i++) {
		check_row(&f, &m, i);
		check_padding(&f, i);
	}
	if (block_entries)
		assert_true(f.block_count > 1);
	assert_true(factors_bytes(&f) >= 8 * f.entries);
	if (!block_entries)
		assert_true(factors_bytes(&f) <= factors_bytes_most(f.entries, side) + 4096);
	factors_finish(&f);
	model_free(&m);
}

static void dense_rows_are_taken_exactly(void **state)
{
	(void)state;
	for (int on_host = 0; on_host < 2; on_host++) {
		check_dense(1, 1, 0, 1, on_host);
		check_dense(6, 2, 0, 4, on_host);
		check_dense(63, 3, 0, 63, on_host);
		check_dense(64, 100, 0, 5, on_host);
		check_dense(1003, 17, 0, 100, on_host);
	}
}

static void blocks_overflow_between_rows(void **state)
{
	(void)state;
	for (int on_host = 0; on_host < 2; on_host++) {
		check_dense(301, 9, 304, 301, on_host); // a full row is a block
		check_dense(301, 9, 1000, 7, on_host);
	}
}

static void a_row_longer_than_a_block_is_refused(void **state)
{
	(void)state;
	struct model m = model_make(40, 1);
	struct factors f;
	struct buffer dense;
	uint32_t word;
	assert_int_equal(factors_init(&f, device, 40, &err), STATUS_OK);
	f.block_entries = 32;
	assert_int_equal(buffer_init_with(&dense, device, m.words, 40 * 40 * 4, &err), STATUS_OK);
	for (int on_host = 0; on_host < 2; on_host++) {
		f.packs_on_host = on_host && device->info.software;
		assert_int_equal(factors_put_dense(&f, &dense, UNIT, m.rows, 40, &err), STATUS_MEMORY);
		// Nothing was taken.
		assert_int_equal(f.entries, 0);
		assert_int_equal(factors_bytes(&f), 0);
		assert_int_equal(f.rows[0].block, NONE);
		assert_int_equal(buffer_read(&dense, device, 0, 4, &word, &err), STATUS_OK);
		assert_int_equal(word, m.words[0]);
	}
	buffer_finish(&dense, device);
	factors_finish(&f);
	model_free(&m);
}

static void what_is_no_row_is_refused(void **state)
{
	(void)state;
	struct factors f;
	struct buffer dense;
	const uint32_t words[4] = {1, 0, 0, 1}, falling[2] = {1, 0}, outside[1] = {2};
	const uint32_t rising[2] = {0, 1};
	const float values[2] = {0.5f, 0.5f}, negative[2] = {0.5f, -0.5f}, none[2] = {NAN, 0.5f},
		    endless[2] = {0.5f, INFINITY};
	struct factors_put row = {.element = 2};
	assert_int_equal(factors_init(&f, device, 2, &err), STATUS_OK);
	assert_int_equal(buffer_init_with(&dense, device, words, sizeof words, &err), STATUS_OK);
	assert_int_equal(factors_put_dense(&f, &dense, UNIT, &row, 1, &err), STATUS_INTERNAL);
	assert_int_equal(factors_put_row(&f, &row, falling, values, 0, &err), STATUS_INTERNAL);
	row.element = 1;
	assert_int_equal(factors_put_row(&f, &row, falling, values, 2, &err), STATUS_INTERNAL);
	assert_int_equal(factors_put_row(&f, &row, outside, values, 1, &err), STATUS_INTERNAL);
	assert_int_equal(factors_put_row(&f, &row, rising, negative, 2, &err), STATUS_INTERNAL);
	assert_int_equal(factors_put_row(&f, &row, rising, none, 2, &err), STATUS_INTERNAL);
	assert_int_equal(factors_put_row(&f, &row, rising, endless, 2, &err), STATUS_INTERNAL);
	assert_int_equal(factors_put_dense(&f, &dense, UNIT, &row, 1, &err), STATUS_OK);
	assert_int_equal(factors_put_dense(&f, &dense, UNIT, &row, 1, &err), STATUS_INTERNAL); // not empty now
	const struct factors_put many[3] = {{.element = 0}, {.element = 0}, {.element = 0}};
	assert_int_equal(factors_put_dense(&f, &dense, UNIT, many, 3, &err), STATUS_INTERNAL); // more than the buffer has
	assert_int_equal(f.entries, 1);
	buffer_finish(&dense, device);
	factors_finish(&f);
}

// ---- single rows
// ----------------------------------------------------------------------------------------------------------

static void put_from_host(struct factors *f, const struct model *m, uint32_t i)
{
	uint32_t n = 0, *columns = malloc(m->side * sizeof *columns);
	float *values = malloc(m->side * sizeof *values);
	assert_true(columns && values);
	for (uint32_t j = 0; j < m->side; j++) {
		const uint32_t word = m->words[(size_t)i * m->side + j];
		if (word) {
			columns[n] = j;
			values[n++] = (float)word * (float)(1 / UNIT);
		}
	}
	assert_int_equal(factors_put_row(f, &m->rows[i], columns, values, n, &err), STATUS_OK);
	free(columns);
	free(values);
}

static void rows_are_replaced_and_removed(void **state)
{
	(void)state;
	struct model m = model_make(500, 5);
	struct factors f;
	assert_int_equal(factors_init(&f, device, 500, &err), STATUS_OK);
	f.block_entries = 4000;
	for (uint32_t i = 0; i < 500; i += 2)
		put_from_host(&f, &m, i);
	for (uint32_t i = 0; i < 500; i += 4) {
		fill_row(&m, i, 3);
		put_from_host(&f, &m, i);
	}
	for (uint32_t i = 0; i < 500; i += 8)
		factors_remove_row(&f, i);
	factors_remove_row(&f, 1); // never put
	check_entries(&f);
	assert_true(f.holes > 0);
	for (int pass = 0; pass < 2; pass++) {
		for (uint32_t i = 0; i < 500; i++) {
			if (i % 2 != 0 || i % 8 == 0) {
				assert_int_equal(f.rows[i].block, NONE);
			} else {
				check_row(&f, &m, i);
				check_padding(&f, i);
			}
		}
		assert_int_equal(factors_compact(&f, &err), STATUS_OK);
		check_entries(&f);
		assert_int_equal(f.holes, 0);
	}
	factors_finish(&f);
	model_free(&m);
}

static void holes_are_closed_in_time(void **state)
{
	(void)state;
	struct model m = model_make(400, 2);
	struct factors f;
	assert_int_equal(factors_init(&f, device, 400, &err), STATUS_OK);
	for (uint32_t turn = 0; turn < 20; turn++)
		for (uint32_t i = 0; i < 400; i++)
			put_from_host(&f, &m, i);
	check_entries(&f);
	assert_true(f.holes <= f.entries + (1u << 18) + 400);
	for (uint32_t i = 0; i < 400; i++)
		check_row(&f, &m, i);
	factors_finish(&f);
	model_free(&m);
}

static void no_room_leaves_the_matrix_alone(void **state)
{
	(void)state;
	struct model m = model_make(300, 1);
	struct factors f;
	struct buffer dense;
	assert_int_equal(factors_init(&f, device, 300, &err), STATUS_OK);
	f.block_entries = 70000;
	assert_int_equal(buffer_init_with(&dense, device, m.words, 300 * 300 * 4, &err), STATUS_OK);
	const uint64_t budget = device->budget;
	device->budget = device->bytes + 300000; // for less than a block
	assert_int_equal(factors_put_dense(&f, &dense, UNIT, m.rows, 300, &err), STATUS_MEMORY);
	assert_int_equal(factors_bytes(&f), 0);
	device->budget = budget;
	assert_int_equal(factors_put_dense(&f, &dense, UNIT, m.rows, 200, &err), STATUS_OK);
	for (uint32_t i = 0; i < 200; i++)
		check_row(&f, &m, i);
	buffer_finish(&dense, device);
	factors_finish(&f);
	model_free(&m);
}

int main(void)
{
	const struct device_options options = {0};
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return SKIPPED;
	}
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(dense_rows_are_taken_exactly),         cmocka_unit_test(blocks_overflow_between_rows),
	    cmocka_unit_test(a_row_longer_than_a_block_is_refused), cmocka_unit_test(what_is_no_row_is_refused),
	    cmocka_unit_test(rows_are_replaced_and_removed),        cmocka_unit_test(holes_are_closed_in_time),
	    cmocka_unit_test(no_room_leaves_the_matrix_alone)};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);
	const bool valid = atomic_load(&device->validation_errors) == 0;
	devices_finish(&(struct devices){.vk = device});
	return failed || !valid;
}
