#include "server/loader/patch_matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define BANNER "%%MatrixMarket"
#define NUMBER_BYTES_MOST 64u // of a value; nine digits, a sign, a point and an exponent are 15

// The text. A zero byte lies at `end`, so that a look at the next byte is always one of the text.
struct text {
	const char *file;
	const char *at, *end;
	uint64_t line;
};

static enum status wrong(const struct text *t, const char *what, struct error *err)
{
	return error_set(err, STATUS_SCENE_INVALID, "'%.60s', line %llu: %s; write it again", t->file,
			 (unsigned long long)t->line, what);
}

// ---- words
// ----------------------------------------------------------------------------------------------------------------

static void skip_blanks(struct text *t)
{
	while (*t->at == ' ' || *t->at == '\t' || (*t->at == '\r' && t->at[1] == '\n'))
		t->at++;
}

static bool ends_word(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == 0;
}

// Go on behind the end of the line. False: there is more on it.
static bool end_line(struct text *t)
{
	skip_blanks(t);
	if (*t->at != '\n')
		return t->at == t->end;
	t->at++;
	t->line++;
	return true;
}

static void skip_line(struct text *t)
{
	const char *stop = memchr(t->at, '\n', (size_t)(t->end - t->at));
	t->line += stop != NULL;
	t->at = stop ? stop + 1 : t->end;
}

// Go to the next line that is not blank. False: there is none.
static bool find_line(struct text *t)
{
	for (skip_blanks(t); *t->at == '\n'; skip_blanks(t))
		end_line(t);
	return t->at < t->end;
}

static bool take_whole(struct text *t, uint32_t *number)
{
	uint64_t n = 0;
	skip_blanks(t);
	const char *from = t->at;
	for (; *t->at >= '0' && *t->at <= '9' && n <= UINT32_MAX; t->at++)
		n = n * 10 + (uint64_t)(*t->at - '0');
	*number = (uint32_t)n;
	return t->at > from && ends_word(*t->at) && n <= UINT32_MAX;
}

// strtof takes the float that is nearest, so nine digits of a float give that float. It would take blanks, hexadecimal and
// words, too; only what a decimal number is made of gets there.
static bool take_value(struct text *t, float *value)
{
	char *stop;
	skip_blanks(t);
	const size_t size = strspn(t->at, "0123456789+-.eE");
	if (size == 0 || size > NUMBER_BYTES_MOST || !ends_word(t->at[size]))
		return false;
	*value = strtof(t->at, &stop);
	const bool whole = stop == t->at + size;
	t->at += size;
	return whole && isfinite(*value);
}

// ---- head and entries
// -----------------------------------------------------------------------------------------------------

// The rest of the first line.
static enum status take_kind(struct text *t, struct error *err)
{
	static const char *const words[] = {"matrix", "coordinate", "real", "general"};
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		skip_blanks(t);
		const size_t size = strlen(words[i]);
		if (strncasecmp(t->at, words[i], size) != 0 || !ends_word(t->at[size]))
			return error_set(err, STATUS_SCENE_UNSUPPORTED,
					 "'%.60s' is no matrix coordinate real general; write it as one", t->file);
		t->at += size;
	}
	return end_line(t) ? STATUS_OK : wrong(t, "the first line goes on behind its last word", err);
}

static enum status take_head(struct text *t, uint32_t *side, uint32_t *entries, struct error *err)
{
	uint32_t columns;
	if (strncmp(t->at, BANNER, strlen(BANNER)) != 0 || !ends_word(t->at[strlen(BANNER)]))
		return error_set(err, STATUS_SCENE_INVALID,
				 "'%.100s' is not a Matrix Market file; give it its proper ending", t->file);
	t->at += strlen(BANNER);
	if (take_kind(t, err) != STATUS_OK)
		return err->code;
	while (find_line(t) && *t->at == '%')
		skip_line(t);
	if (!take_whole(t, side) || !take_whole(t, &columns) || !take_whole(t, entries) || !end_line(t))
		return wrong(t, "there should be the numbers of rows, columns and entries", err);
	if (*side != columns || *side == 0)
		return wrong(t, "form factors are a square matrix of at least one row", err);
	if (*side > LIMIT_PATCH_ELEMENTS || *entries > LIMIT_PATCH_ENTRIES)
		return error_set(err, STATUS_SCENE_LIMIT,
				 "'%.60s' has %u rows and %u entries, %u and %u are the most: write it of fewer patches",
				 t->file, *side, *entries, LIMIT_PATCH_ELEMENTS, LIMIT_PATCH_ENTRIES);
	// The least that an entry takes is "1 1 1", and all but the last an end of the line.
	if (*entries > ((uint64_t)(t->end - t->at) + 1) / 6)
		return wrong(t, "the file is too short for as many entries", err);
	return STATUS_OK;
}

// Count the entries of each row. What follows the number of the row is looked at later.
static enum status count_rows(struct text t, struct imported_row *rows, uint32_t side, uint32_t entries, struct error *err)
{
	uint32_t row, found = 0;
	for (; find_line(&t); found++) {
		if (!take_whole(&t, &row) || row == 0 || row > side)
			return wrong(&t, "an entry's row is none", err);
		if (found == entries)
			return wrong(&t, "there are more entries than their number", err);
		rows[row - 1].count++;
		skip_line(&t);
	}
	return found == entries ? STATUS_OK : wrong(&t, "there are fewer entries than their number", err);
}

// Each entry goes behind those of its row that came before it. `next`: where, by row.
static enum status take_entries(struct text *t, uint32_t *next, uint32_t side, struct imported_factor *factors,
				struct error *err)
{
	uint32_t row, column;
	float value;
	while (find_line(t)) {
		if (!take_whole(t, &row) || !take_whole(t, &column) || column == 0 || column > side)
			return wrong(t, "an entry's column is none", err);
		if (!take_value(t, &value) || value < 0)
			return wrong(t, "a form factor is no number or negative", err);
		if (!end_line(t))
			return wrong(t, "an entry goes on behind its value", err);
		factors[next[row - 1]++] = (struct imported_factor){column - 1, value + 0.0f}; // no negative zero
	}
	return STATUS_OK;
}

// ---- order
// ----------------------------------------------------------------------------------------------------------------

static void lay_rows(struct imported_row *rows, uint32_t side)
{
	for (uint32_t i = 0, first = 0; i < side; i++) {
		rows[i].first = first;
		first += rows[i].count;
	}
}

// The transposed matrix: its rows, which are zero before, and its entries. In each of its rows columns do not descend, for
// the rows of `from` are gone through in order. `next`: room for a number a row.
static void transpose(const struct imported_row *from_rows, const struct imported_factor *from, uint32_t side,
		      uint32_t count, struct imported_row *rows, struct imported_factor *factors, uint32_t *next)
{
	for (uint32_t k = 0; k < count; k++)
		rows[from[k].column].count++;
	lay_rows(rows, side);
	for (uint32_t i = 0; i < side; i++)
		next[i] = rows[i].first;
	for (uint32_t i = 0; i < side; i++)
		for (uint32_t k = from_rows[i].first; k < from_rows[i].first + from_rows[i].count; k++)
			factors[next[from[k].column]++] = (struct imported_factor){i, from[k].value};
}

static bool ascends(const struct import *im)
{
	for (size_t i = 0; i < im->row_count; i++)
		for (uint32_t k = 1; k < im->rows[i].count; k++)
			if (im->factors[im->rows[i].first + k].column < im->factors[im->rows[i].first + k - 1].column)
				return false;
	return true;
}

// Put the entries of every row in order: what is transposed twice is as it was, in order.
static enum status sort_rows(struct import *im, uint32_t *next, struct error *err)
{
	const uint32_t side = (uint32_t)im->row_count, count = (uint32_t)im->factor_count;
	if (ascends(im))
		return STATUS_OK;
	struct imported_row *rows = calloc(side, sizeof *rows);
	struct imported_factor *factors = malloc((size_t)count * sizeof *factors);
	enum status status = STATUS_OK;
	if (rows && factors) {
		transpose(im->rows, im->factors, side, count, rows, factors, next);
		memset(im->rows, 0, side * sizeof *im->rows);
		transpose(rows, factors, side, count, im->rows, im->factors, next);
	} else {
		status = error_set(err, STATUS_MEMORY, "no memory to sort %u form factors", count);
	}
	free(rows);
	free(factors);
	return status;
}

// ---- the file
// -------------------------------------------------------------------------------------------------------------

static enum status check_rows(struct import *im, const char *file, struct error *err)
{
	uint32_t more = 0;
	for (uint32_t i = 0; i < im->row_count; i++) {
		const struct imported_factor *entries = &im->factors[im->rows[i].first];
		const char *fault = imported_row_fault(entries, im->rows[i].count, (uint32_t)im->row_count);
		if (fault)
			return error_set(err, STATUS_SCENE_INVALID, "'%.60s', row %u: %s; write it again", file, i + 1,
					 fault);
		more += imported_row_sum(entries, im->rows[i].count) > IMPORTED_SUM_MOST;
	}
	if (more > 0)
		import_warn(im, "rows that sum up to more than 1, as they do with mirrors: %u", more);
	return STATUS_OK;
}

static enum status read_rows(struct import *im, struct text *t, uint32_t *next, struct error *err)
{
	const uint32_t side = (uint32_t)im->row_count;
	if (count_rows(*t, im->rows, side, (uint32_t)im->factor_count, err) != STATUS_OK)
		return err->code;
	lay_rows(im->rows, side);
	for (uint32_t i = 0; i < side; i++)
		next[i] = im->rows[i].first;
	enum status status = take_entries(t, next, side, im->factors, err);
	if (status == STATUS_OK)
		status = sort_rows(im, next, err);
	return status == STATUS_OK ? check_rows(im, t->file, err) : status;
}

enum status patch_matrix_import(struct import *im, const char *file, const struct file_bytes *bytes, struct error *err)
{
	const char *at = (const char *)bytes->data;
	struct text t = {.file = file, .at = at, .end = at + bytes->size, .line = 1};
	uint32_t side, entries;
	if (take_head(&t, &side, &entries, err) != STATUS_OK)
		return err->code;
	uint32_t *next = malloc(side * sizeof *next);
	im->rows = calloc(side, sizeof *im->rows);
	im->factors = malloc(((size_t)entries + 1) * sizeof *im->factors);
	im->row_count = side;
	im->factor_count = entries;
	const enum status status = next && im->rows && im->factors
				       ? read_rows(im, &t, next, err)
				       : error_set(err, STATUS_MEMORY, "no memory for %u form factors", entries);
	free(next);
	return status;
}
