#include "server/scene/patch_format.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

static bool corners_are_sane(const struct imported_element *e)
{
	for (uint32_t k = 0; k < 4; k++)
		for (uint32_t c = 0; c < 3; c++) {
			const double x = e->corner[k][c];
			if (k < e->corners ? !(fabs(x) <= LIMIT_COORDINATE) : x < 0 || x > 0 || isnan(x))
				return false;
		}
	return true;
}

static bool light_is_sane(const float light[3])
{
	for (int c = 0; c < 3; c++)
		if (!(light[c] >= 0 && (double)light[c] <= LIMIT_EXITANCE))
			return false;
	return true;
}

static bool is_share(float value)
{
	return value >= 0 && value <= 1;
}

const char *imported_element_fault(const struct imported_element *e, uint32_t i, uint32_t count)
{
	const uint32_t patches = count / 2;
	if (count % 2 != 0)
		return "elements are not two for each patch";
	if (e->patch != (i < patches ? i : i - patches) || e->side != (i >= patches))
		return "elements are not the fronts of all patches in order, then their backs";
	if (e->corners != 3 && e->corners != 4)
		return "an element has neither three corners nor four";
	if (!corners_are_sane(e))
		return "a corner of an element is out of range";
	if (e->material >= LIMIT_MATERIALS)
		return "an element's material is out of range";
	if (!(e->area >= 0 && isfinite(e->area)))
		return "an element's area is out of range";
	if (!light_is_sane(e->b) || !light_is_sane(e->m) || !light_is_sane(e->d) || !light_is_sane(e->h))
		return "an element's light is out of range";
	if (!is_share(e->rho[0]) || !is_share(e->rho[1]) || !is_share(e->rho[2]))
		return "an element's reflectance is out of range";
	if (!is_share(e->escaped) || !is_share(e->cut) || (e->reached == 0 && (e->escaped > 0 || e->cut > 0)))
		return "a share of an element's light is out of range";
	if (e->straight > 1 || e->reached > 1 || e->reserved != 0)
		return "a mark of an element is neither 0 nor 1";
	return NULL;
}

const char *imported_row_fault(const struct imported_factor *entries, uint32_t count, uint32_t side)
{
	double sum = 0;
	for (uint32_t k = 0; k < count; k++) {
		if (entries[k].column >= side)
			return "a form factor is to an element that is not there";
		if (k > 0 && entries[k].column <= entries[k - 1].column)
			return "a row has two form factors to one element";
		if (!(entries[k].value >= 0))
			return "a form factor is negative or no number";
		sum += (double)entries[k].value;
	}
	return sum <= IMPORTED_ROW_MOST ? NULL : "form factors of a row sum up to more than mirrors can make of them";
}
