#include "server/worker/technique/radiosity/imported.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/angle.h"
#include "server/base/clock.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/radiosity/solution.h"

#define ELEMENTS_AT_ONCE 256u // between two looks at the clock

bool imported_factors(const struct plan *plan)
{
	return plan->imported.elements > 0 && plan->imported.factors;
}

bool imported_solution(const struct plan *plan)
{
	return plan->imported.elements > 0 && !plan->imported.factors;
}

enum status imported_check(const struct plan_imported *imported, const struct elements *e, struct error *err)
{
	if (imported->elements == e->count)
		return STATUS_OK;
	return error_set(err, STATUS_BAD_ARGUMENT,
			 "the imported file has %u sides of patches, and the scene has %u by this request: give "
			 "radiosity.patches or radiosity.edge as when the file was made, or the scene that it is of",
			 imported->elements, e->count);
}

// ---- rows of form factors -----------------------------------------------------------------------------------------------

struct imported_rows {
	const struct imported_row *rows; // of the file
	const struct imported_factor *entries;
	uint32_t *columns; // room for the longest row
	float *values;
};

enum status imported_rows_create(const struct plan_imported *imported, const struct elements *elements,
				 struct imported_rows **out, struct error *err)
{
	size_t most = 0;
	enum status s = imported_check(imported, elements, err);
	if (s != STATUS_OK)
		return s;
	struct imported_rows *r = calloc(1, sizeof *r);
	if (!r)
		return error_set(err, STATUS_MEMORY, "out of memory");
	r->rows = scene_section(imported->scene, BLOB_FACTOR_ROWS);
	r->entries = scene_section(imported->scene, BLOB_FACTOR_ENTRIES);
	for (uint32_t i = 0; i < imported->elements; i++)
		most = r->rows[i].count > most ? r->rows[i].count : most;
	r->columns = malloc((most + 1) * sizeof *r->columns);
	r->values = malloc((most + 1) * sizeof *r->values);
	if (!r->columns || !r->values) {
		imported_rows_destroy(r);
		return error_set(err, STATUS_MEMORY, "out of memory");
	}
	*out = r;
	return STATUS_OK;
}

void imported_rows_destroy(struct imported_rows *r)
{
	if (!r)
		return;
	free(r->columns);
	free(r->values);
	free(r);
}

enum status imported_rows_put(const struct imported_rows *r, uint32_t element, struct factors *factors, struct error *err)
{
	const struct imported_row *row = &r->rows[element];
	double sum = 0;
	for (uint32_t k = 0; k < row->count; k++) {
		const struct imported_factor *f = &r->entries[row->first + k];
		r->columns[k] = f->column;
		r->values[k] = f->value;
		sum += (double)f->value;
	}
	// Mirrors count a share for each surface that it meets, so a sum may be above 1.
	const struct factors_put put = {.element = element, .escaped = (float)fmax(1 - sum, 0)};
	return factors_put_row(factors, &put, r->columns, r->values, row->count, err);
}

// ---- a solution ---------------------------------------------------------------------------------------------------------

// The corner of an element as files have it: counter-clockwise seen from its own side.
static bool same_corners(const struct imported_element *of, const struct elements *e, uint32_t patch, const double origin[3])
{
	double world[4][3];
	const uint32_t count = elements_corners(e, patch, origin, world);
	bool same = of->corners == count;
	for (uint32_t k = 0; same && k < count; k++)
		same = !memcmp(world[of->side ? count - 1 - k : k], of->corner[k], sizeof *world);
	return same;
}

// What of an element is another than the file says; NULL: nothing.
static const char *find_difference(const struct solution *v, const struct imported_element *of, uint32_t element)
{
	const struct elements *e = &v->factors->elements;
	const struct radiosity_surface *surface = &v->made_of[element];
	const uint32_t patch = element % e->patches.count;
	struct patch shape;
	if (of->patch != patch || of->side != (element >= e->patches.count) ||
	    !same_corners(of, e, patch, v->scene->view.blob->origin))
		return "is elsewhere";
	patches_get(&e->patches, patch, &shape);
	if (of->material != shape.material)
		return "is of another material";
	for (uint32_t c = 0; c < 3; c++) {
		if ((float)PI * surface->emission[c] != of->m[c])
			return "emits other light";
		if (surface->albedo[c] != of->rho[c])
			return "reflects otherwise";
	}
	return e->shapes[patch].area != of->area ? "is of another size" : NULL;
}

static enum status take_element(struct solution *v, const struct imported_element *of, uint32_t element, struct error *err)
{
	const char *difference = find_difference(v, of, element);
	if (difference)
		return error_set(
		    err, STATUS_BAD_ARGUMENT,
		    "the imported file is of another scene, other patches, materials or effects: element %u %s. "
		    "Render what the file was made of, or make it anew",
		    element, difference);
	memcpy(&v->irradiance[3 * (size_t)element], of->h, sizeof of->h);
	memcpy(&v->direct[3 * (size_t)element], of->d, sizeof of->d);
	v->reached[element] = of->reached;
	v->lamps = of->straight;
	const struct factors_put row = {.element = element, .escaped = of->escaped, .cut = of->cut};
	return of->reached ? factors_put_row(&v->factors->factors, &row, NULL, NULL, 0, err) : STATUS_OK;
}

enum status imported_take(struct solution *v, const struct resident_scene *file, uint32_t *next, uint32_t budget_us,
			  struct error *err)
{
	const struct imported_element *elements = scene_section(file, BLOB_PATCH_ELEMENTS);
	const uint32_t count = v->factors->elements.count;
	const uint64_t start = clock_us();
	enum status s = STATUS_OK;
	do
		for (uint32_t i = 0; s == STATUS_OK && i < ELEMENTS_AT_ONCE && *next < count; i++) {
			s = take_element(v, &elements[*next], *next, err);
			*next += s == STATUS_OK;
		}
	while (s == STATUS_OK && *next < count && clock_us() - start < budget_us);
	return s;
}
