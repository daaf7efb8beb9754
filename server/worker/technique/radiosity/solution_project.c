// The stage in which form factors are projected (radiosity.project). The projection is of the rows that this solution's
// light reaches and stays with it: what the scene keeps beside them, and may get meanwhile, changes nothing.
#include <stdlib.h>

#include "server/worker/technique/radiosity/factors_project.h"
#include "server/worker/technique/radiosity/radiosity_options.h"
#include "server/worker/technique/radiosity/solution_parts.h"

struct solution_projecting {
	float *area; // by element
	struct factors_projection projection;
};

void solution_end_projecting(struct solution *v)
{
	struct solution_projecting *p = v->projecting;
	if (!p)
		return;
	factors_projection_finish(&p->projection);
	free(p->area);
	free(p);
	v->projecting = NULL;
}

static enum status begin(struct solution *v, struct error *err)
{
	const struct factors_wish wish = {.average = v->options.project == RADIOSITY_PROJECT_BOTH, .close = true};
	struct solution_projecting *p = v->projecting = calloc(1, sizeof *p);
	if (!p)
		return error_set(err, STATUS_MEMORY, "out of memory");
	enum status s = element_buffers_areas(&v->factors->buffers, &v->factors->elements, v->device, &p->area, err);
	if (s == STATUS_OK)
		s = factors_projection_init(&p->projection, &v->factors->factors, p->area, v->reached, &wish, err);
	if (s != STATUS_OK)
		solution_end_projecting(v);
	return s;
}

enum status solution_project(struct solution *v, uint32_t budget_us, bool *done, struct error *err)
{
	enum status s = v->projecting ? STATUS_OK : begin(v, err);
	if (s == STATUS_OK)
		s = factors_projection_step(&v->projecting->projection, budget_us, err);
	*done = s == STATUS_OK && factors_projection_finished(&v->projecting->projection);
	if (!*done)
		return s;
	factors_projection_take(&v->projecting->projection, &v->projected);
	solution_end_projecting(v);
	return STATUS_OK;
}
