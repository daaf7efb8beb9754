// What a request is about: the scenes that it names, by their part in it. Whoever works on the request, a job, a sweep or a
// quote, holds them meanwhile.
//
// For the front's one thread.
#ifndef CANDIL_FRONT_SUBJECT_H
#define CANDIL_FRONT_SUBJECT_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/base/part.h"

struct scene;

// The scenes of a request; NULL: it names none for that part.
struct subject {
	struct scene *part[PARTS];
};

// Their hashes, of content, as their loaders told, so they may be any text; "": there is none.
struct subject_hashes {
	char part[PARTS][sizeof((candil_SceneInfo *)0)->hash];
};

// Be a user of all its scenes, or no longer (scenes.h).
void subject_hold(const struct subject *subject);
void subject_release(const struct subject *subject);

// Are all its scenes loaded? And is this one of them?
bool subject_is_ready(const struct subject *subject);
bool subject_has(const struct subject *subject, const struct scene *scene);

struct subject_hashes subject_hashes_of(const struct subject *subject);

// The numbers by which a worker knows them; 0: there is none.
void subject_ids(const struct subject *subject, uint64_t ids[PARTS]);

#endif
