// Mirrors as portals: what a cell sees in a mirror is drawn as its mirror image sees it, within the pixels that see the
// mirror, and of that what is in front of the mirror. Each pixel keeps its own weight on the way, so light is neither made
// nor lost.
#include <stdlib.h>

#include "server/base/vec3.h"
#include "server/worker/technique/radiosity/hemicube_job.h"

#define PLANE_BITS 8u // of a plane in a cell's words: a bit for each face

static void reflect(const struct hemicube_plane *p, double offset, double v[3])
{
	const double twice = 2 * (vec3_dot(p->normal, v) - offset);
	for (int c = 0; c < 3; c++)
		v[c] -= twice * p->normal[c];
}

static struct hemicube_view mirrored(const struct hemicube *h, const struct hemicube_view *from, uint32_t parent,
				     uint32_t plane, uint32_t faces)
{
	struct hemicube_view v = *from;
	const struct hemicube_plane *p = &h->planes.list[plane];
	reflect(p, p->offset, v.origin.at);
	reflect(p, 0, v.origin.x);
	reflect(p, 0, v.origin.y);
	reflect(p, 0, v.origin.z);
	v.parent = parent;
	v.plane = plane + 1;
	v.faces = faces;
	return v;
}

// Fill the next level with cells that look into mirrors of this one, as many as there is room for. 0: there are no more.
static uint32_t next_views(struct hemicube *h, uint32_t level)
{
	struct hemicube_level *from = &h->levels[level], *to = &h->levels[level + 1];
	to->count = 0;
	while (from->cell < from->count && to->count < h->cells_most) {
		const uint32_t word = from->seen[from->cell * h->seen_words + from->plane * PLANE_BITS / 32];
		const uint32_t faces = word >> from->plane * PLANE_BITS % 32 & HEMICUBE_ALL_FACES;
		if (faces)
			to->views[to->count++] = mirrored(h, &from->views[from->cell], from->cell, from->plane, faces);
		if (++from->plane == h->planes.count) {
			from->plane = 0;
			from->cell++;
		}
	}
	return to->count;
}

// Draw a level and learn which mirrors its cells see.
static enum status enter(struct hemicube *h, uint32_t level, struct error *err)
{
	struct hemicube_level *l = &h->levels[level];
	enum status s = hemicube_pass(h, level, err);
	l->cell = l->plane = 0;
	if (s == STATUS_OK && hemicube_has_portals(h) && level < h->options.bounces)
		s = gl_buffer_read(&h->seen, h->device, 0, (uint64_t)l->count * h->seen_words * sizeof *l->seen, l->seen,
				   err);
	return s;
}

// Whether the driver has let all rays of a pass end.
static enum status check_rays(const struct hemicube *h, struct error *err)
{
	struct hemicube_pixels head;
	const enum status s = gl_buffer_read(&h->pixels, h->device, 0, sizeof head, &head, err);
	if (s == STATUS_OK && head.cut)
		return error_set(err, STATUS_TRAVERSAL_CUT,
				 "the driver ended a loop of the traversal: the form factors would be wrong");
	return s;
}

enum status hemicube_look(struct hemicube *h, struct error *err)
{
	uint32_t level = 0;
	enum status s = enter(h, level, err);
	if (s == STATUS_OK && hemicube_has_rays(h))
		s = check_rays(h, err);
	while (s == STATUS_OK && hemicube_has_portals(h)) {
		if (level < h->options.bounces && next_views(h, level) > 0)
			s = enter(h, ++level, err);
		else if (level > 0)
			level--;
		else
			break;
	}
	return s;
}

enum status hemicube_look_anyway(struct hemicube *h, struct error *err)
{
	if (h->options.bounces == 0)
		return STATUS_OK;
	h->levels[1].views[0] = mirrored(h, &h->levels[0].views[0], 0, 0, HEMICUBE_ALL_FACES);
	h->levels[1].count = 1;
	return hemicube_pass(h, 1, err);
}
