#include "server/scene/blob_check_patches.h"

static enum status bad(struct error *err, const char *what)
{
	return error_set(err, STATUS_SCENE_INVALID, "the scene blob is damaged: %s; load the scene again", what);
}

static enum status check_elements(const struct blob_header *h, struct error *err)
{
	const struct imported_element *elements = blob_section(h, BLOB_PATCH_ELEMENTS);
	const uint32_t count = blob_count(h, BLOB_PATCH_ELEMENTS);
	for (uint32_t i = 0; i < count; i++) {
		const char *fault = imported_element_fault(&elements[i], i, count);
		if (fault)
			return bad(err, fault);
		if (elements[i].straight != elements[0].straight)
			return bad(err, "its elements have their light in two ways");
	}
	return STATUS_OK;
}

static enum status check_rows(const struct blob_header *h, struct error *err)
{
	const struct imported_row *rows = blob_section(h, BLOB_FACTOR_ROWS);
	const struct imported_factor *entries = blob_section(h, BLOB_FACTOR_ENTRIES);
	const uint32_t side = blob_count(h, BLOB_FACTOR_ROWS), count = blob_count(h, BLOB_FACTOR_ENTRIES);
	uint32_t next = 0;
	for (uint32_t i = 0; i < side; i++) {
		if (rows[i].first != next || rows[i].count > count - next)
			return bad(err, "its rows of form factors are not side by side");
		const char *fault = imported_row_fault(&entries[next], rows[i].count, side);
		if (fault)
			return bad(err, fault);
		next += rows[i].count;
	}
	return next == count ? STATUS_OK : bad(err, "some form factors belong to no row");
}

enum status blob_check_patches(const struct blob_header *h, struct error *err)
{
	const enum status status = check_elements(h, err);
	return status == STATUS_OK ? check_rows(h, err) : status;
}
