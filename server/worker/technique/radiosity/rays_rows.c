// Rows of rays.h, put into factors.h.
#include "server/worker/technique/radiosity/rays.h"

enum status rays_rows(struct rays *r, const uint32_t *elements, uint32_t count, struct factors *factors, struct error *err)
{
	enum status s = rays_trace(r, elements, count, err);
	if (s != STATUS_OK || count == 0)
		return s;
	s = factors_put_dense(factors, rays_dense(r), rays_unit(r), rays_lost(r), count, err);
	struct error other;
	if (s != STATUS_OK && !factors->device->lost)
		rays_clear(r, &other);
	return s;
}
