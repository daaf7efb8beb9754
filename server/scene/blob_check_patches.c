#include "server/scene/blob_check_patches.h"

static enum status bad(struct error *err, const char *what)
{
	return error_set(err, STATUS_SCENE_INVALID, "the scene blob is damaged: %s; load the scene again", what);
}

static enum status check_elements(const struct blob_header *h, struct error *err)
{
	uint32_t which;
	const char *fault =
	    imported_elements_fault(blob_section(h, BLOB_PATCH_ELEMENTS), blob_count(h, BLOB_PATCH_ELEMENTS), &which);
	return fault ? bad(err, fault) : STATUS_OK;
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
