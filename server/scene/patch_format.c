#include "server/scene/patch_format.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

// ---- properties ---------------------------------------------------------------------------------------------------------

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are written as they are in memory");

_Static_assert(offsetof(struct imported_element, reserved) + sizeof(uint32_t) == sizeof(struct imported_element) &&
		   offsetof(struct imported_element, patch) == 4 * 3 * sizeof(double),
	       "there is nothing between its members, for blobs are hashed");

#define PROPERTY(type, name, member) \
	{#type, name, offsetof(struct imported_element, member), sizeof((const struct imported_element *)NULL)->member},
static const struct patch_property properties[] = {PATCH_PROPERTIES(PROPERTY)};

#define BYTES(type, name, member) +(uint32_t)sizeof((const struct imported_element *)NULL)->member
_Static_assert(1 + 4 * sizeof(uint32_t) PATCH_PROPERTIES(BYTES) <= PATCH_FACE_BYTES_MOST, "a face has more bytes");

const struct patch_property *patch_properties(uint32_t *count)
{
	*count = sizeof properties / sizeof *properties;
	return properties;
}

uint32_t patch_face_write(const struct imported_element *e, const uint32_t vertex[4], char *out)
{
	char *at = out;
	*at++ = (char)e->corners;
	memcpy(at, vertex, e->corners * sizeof *vertex);
	at += e->corners * sizeof *vertex;
	for (size_t i = 0; i < sizeof properties / sizeof *properties; i++) {
		memcpy(at, (const char *)e + properties[i].offset, properties[i].bytes);
		at += properties[i].bytes;
	}
	return (uint32_t)(at - out);
}

// ---- faults -------------------------------------------------------------------------------------------------------------

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

static const char *element_fault(const struct imported_element *e, uint32_t i, uint32_t patches)
{
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

const char *imported_elements_fault(const struct imported_element *elements, uint32_t count, uint32_t *which)
{
	const char *fault = NULL;
	*which = 0;
	if (count % 2 != 0)
		return "elements are not two for each patch";
	for (uint32_t i = 0; i < count && !fault; i++) {
		*which = i;
		fault = element_fault(&elements[i], i, count / 2);
		if (!fault && elements[i].straight != elements[0].straight)
			fault = "elements have their light in two ways";
	}
	return fault;
}

double imported_row_sum(const struct imported_factor *entries, uint32_t count)
{
	double sum = 0;
	for (uint32_t k = 0; k < count; k++)
		sum += (double)entries[k].value;
	return sum;
}

const char *imported_row_fault(const struct imported_factor *entries, uint32_t count, uint32_t side)
{
	for (uint32_t k = 0; k < count; k++) {
		if (entries[k].column >= side)
			return "a form factor is to an element that is not there";
		if (k > 0 && entries[k].column <= entries[k - 1].column)
			return "a row has two form factors to one element";
		if (!(entries[k].value >= 0))
			return "a form factor is negative or no number";
	}
	return imported_row_sum(entries, count) <= IMPORTED_ROW_MOST
		   ? NULL
		   : "form factors of a row sum up to more than mirrors can make of them";
}
