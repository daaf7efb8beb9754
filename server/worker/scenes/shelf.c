#include "server/worker/scenes/shelf.h"

#include <stdlib.h>

static void shelf_destroy(struct derived *derived)
{
	struct shelf *s = (struct shelf *)derived;
	while (s->first) {
		struct shelved *thing = s->first;
		s->first = thing->next;
		s->kind->destroy(thing, true);
	}
	free(s);
}

static void drop(struct shelf *s, struct shelved *thing)
{
	struct shelved **at = &s->first;
	while (*at != thing)
		at = &(*at)->next;
	*at = thing->next;
	s->kind->destroy(thing, false);
}

bool shelf_drop_idle(struct shelf *s, uint32_t kept)
{
	struct shelved *oldest = NULL;
	uint32_t idle = 0;
	for (struct shelved *thing = s->first; thing; thing = thing->next) {
		if (thing->users > 0)
			continue;
		idle++;
		oldest = !oldest || thing->used < oldest->used ? thing : oldest;
	}
	if (idle <= kept)
		return false;
	drop(s, oldest);
	return true;
}

static bool shelf_trim(struct derived *derived)
{
	return shelf_drop_idle((struct shelf *)derived, 0);
}

static uint64_t shelf_idle_bytes(const struct derived *derived)
{
	const struct shelf *s = (const struct shelf *)derived;
	uint64_t bytes = 0;
	for (const struct shelved *thing = s->first; thing; thing = thing->next)
		bytes += thing->users == 0 ? s->kind->bytes(thing) : 0;
	return bytes;
}

struct shelf *shelf_of(struct resident_scene *of, const struct shelf_kind *kind)
{
	struct resident_scene *scene = of->base ? of->base : of;
	struct shelf *s = (struct shelf *)resident_derived(scene, kind);
	if (s)
		return s;
	s = calloc(1, sizeof *s);
	if (s) {
		s->kind = kind;
		s->derived =
		    (struct derived){.kind = kind, .destroy = shelf_destroy, .trim = shelf_trim, .bytes = shelf_idle_bytes};
		resident_derive(scene, &s->derived);
	}
	return s;
}

void shelf_put(struct shelf *s, struct shelved *thing)
{
	*thing = (struct shelved){.next = s->first, .shelf = s};
	s->first = thing;
}

void shelf_hold(struct shelved *thing)
{
	thing->users++;
	thing->used = ++thing->shelf->turn;
}

void shelf_release(struct shelved *thing)
{
	struct shelf *s = thing->shelf;
	if (--thing->users == 0 && !s->kind->finished(thing))
		drop(s, thing);
	while (shelf_drop_idle(s, s->kind->kept))
		;
}
