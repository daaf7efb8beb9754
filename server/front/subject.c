#include "server/front/subject.h"

#include <string.h>

#include "server/front/scenes.h"

void subject_hold(const struct subject *s)
{
	for (unsigned i = 0; i < PARTS; i++)
		if (s->part[i])
			scene_hold(s->part[i]);
}

void subject_release(const struct subject *s)
{
	for (unsigned i = 0; i < PARTS; i++)
		if (s->part[i])
			scene_release(s->part[i]);
}

bool subject_is_ready(const struct subject *s)
{
	for (unsigned i = 0; i < PARTS; i++)
		if (s->part[i] && s->part[i]->state != SCENE_READY)
			return false;
	return true;
}

bool subject_has(const struct subject *s, const struct scene *scene)
{
	for (unsigned i = 0; i < PARTS; i++)
		if (s->part[i] == scene)
			return true;
	return false;
}

struct subject_hashes subject_hashes_of(const struct subject *s)
{
	struct subject_hashes hashes = {0};
	for (unsigned i = 0; i < PARTS; i++)
		if (s->part[i])
			memcpy(hashes.part[i], s->part[i]->info.hash, sizeof hashes.part[i]);
	return hashes;
}

void subject_ids(const struct subject *s, uint64_t ids[PARTS])
{
	for (unsigned i = 0; i < PARTS; i++)
		ids[i] = s->part[i] ? s->part[i]->id : 0;
}
