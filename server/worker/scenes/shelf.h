// Shelves: what a technique makes from a scene, in slices, and keeps for later jobs, such as voxels, volumes and shadow
// maps. A scene as loaded has one shelf for each kind of thing, which all its variants share. The kind's maker decides which
// thing on the shelf serves a job. A thing stays while somebody holds it, finished or not. Of things that nobody holds,
// unfinished ones are destroyed at once, and finished ones beyond the latest few, or all of them where memory is short.
// Device's thread only.
//
//   shelf_of; look from `first` along `next`, else make a thing and shelf_put it; shelf_hold … shelf_release
//
// Example: a whole program: two jobs share one thing, which is made once
//	#include <assert.h>
//	#include <stdlib.h>
//
//	#include "server/worker/scenes/shelf.h"
//
//	struct thing {
//		struct shelved shelved; // first: the shelf hands it back
//		bool done;
//	};
//
//	static bool thing_finished(const struct shelved *shelved)
//	{
//		return ((const struct thing *)shelved)->done;
//	}
//
//	static uint64_t thing_bytes(const struct shelved *shelved)
//	{
//		(void)shelved;
//		return 0; // it has no device memory
//	}
//
//	static void thing_destroy(struct shelved *shelved, bool scene_goes)
//	{
//		(void)scene_goes;
//		free(shelved);
//	}
//
//	static const struct shelf_kind thing_kind = {2, thing_finished, thing_bytes, thing_destroy};
//
//	static struct thing *thing_acquire(struct resident_scene *scene)
//	{
//		struct shelf *shelf = shelf_of(scene, &thing_kind);
//		if (!shelf)
//			return NULL;
//		struct thing *t = (struct thing *)shelf->first; // here any serves any job
//		if (!t && (t = calloc(1, sizeof *t)))
//			shelf_put(shelf, &t->shelved);
//		if (t)
//			shelf_hold(&t->shelved);
//		return t;
//	}
//
//	int main(void)
//	{
//		struct resident_scenes scenes = {NULL};
//		struct error err;
//		if (resident_add(&scenes, 1, -1, &err) != STATUS_OK)
//			return 1;
//		struct thing *one = thing_acquire(scenes.first), *two = thing_acquire(scenes.first);
//		assert(one && one == two);
//		one->done = true;
//		shelf_release(&one->shelved);
//		shelf_release(&two->shelved); // nobody holds it; it stays, for it is finished
//		assert(thing_acquire(scenes.first) == one);
//		resident_finish(&scenes);
//		return 0;
//	}
#ifndef CANDIL_WORKER_TECHNIQUE_SHELF_H
#define CANDIL_WORKER_TECHNIQUE_SHELF_H

#include "server/worker/scenes/resident.h"

struct shelf;

// The first member of a thing. shelf_put fills it in.
struct shelved {
	struct shelved *next; // the one put before it
	struct shelf *shelf; // that it is on
	uint32_t users; // holds of it, by jobs and by things on other shelves
	uint64_t used; // shelf->turn when it was last held
};

// A kind of thing: what its maker tells the shelf. One static constant each, whose address identifies the shelf.
struct shelf_kind {
	uint32_t kept; // the most finished things that are kept while nobody holds them, for a scene and its variants
	bool (*finished)(const struct shelved *thing); // its making is over
	uint64_t (*bytes)(
	    const struct shelved *thing); // device memory that destroying a thing which nobody holds would free
	// Free a thing. scene_goes: everything made from the scene is being destroyed, in any order, so that things of
	// other shelves which this one holds may be gone already.
	void (*destroy)(struct shelved *thing, bool scene_goes);
};

// A shelf, owned by its scene.
struct shelf {
	struct derived derived;
	const struct shelf_kind *kind;
	struct shelved *first;
	uint64_t turn;
};

// The shelf for a kind with a scene, or with the base of a variant; made if it is not there. NULL: out of memory.
struct shelf *shelf_of(struct resident_scene *scene, const struct shelf_kind *kind);

// Put a new thing on the shelf, which owns it from now on. Nobody holds it yet.
void shelf_put(struct shelf *shelf, struct shelved *thing);

// Hold a thing on a shelf: it stays until it is released as often as it was held.
void shelf_hold(struct shelved *thing);

// Let go of a thing, once for each shelf_hold. The thing may be gone afterwards.
void shelf_release(struct shelved *thing);

// If more than `kept` things are held by nobody, destroy the least recently held of them. False: there are not so many.
bool shelf_drop_idle(struct shelf *shelf, uint32_t kept);

#endif
