// Things that a technique makes of a scene, in slices, and keeps for the jobs that come after: voxels, volumes, shadow maps.
// Each kind has one shelf with a scene as it was loaded, for it and all its variants; which thing on it serves a job is its
// maker's to say. A thing stays while somebody holds it, finished or not. Of those that nobody holds the unfinished go at
// once, the others but the latest few, and these too where memory is short. Device's thread only.
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

// First member of what is kept. Zero it, or copy it from one that is on no shelf; shelf_put does the rest.
struct shelved {
	struct shelved *next; // the shelf's newest is first
	struct shelf *shelf;
	uint32_t users; // jobs, and things on other shelves, that hold it
	uint64_t used; // when it was last held, in turns of the shelf
};

// What a maker tells of its things. One constant each: its address tells the shelves of a scene apart.
struct shelf_kind {
	uint32_t kept; // finished things that nobody holds, at most, of one scene and its variants
	bool (*finished)(const struct shelved *thing);
	uint64_t (*bytes)(const struct shelved *thing); // device memory that goes with it, of one that nobody holds
	// Free it. scene_goes: with all else that was made of the scene, in any order, so that what it holds there may be
	// gone.
	void (*destroy)(struct shelved *thing, bool scene_goes);
};

struct shelf {
	struct derived derived;
	const struct shelf_kind *kind;
	struct shelved *first;
	uint64_t turn;
};

// The shelf of a scene, or of a variant's base; made if it is not there. NULL: out of memory.
struct shelf *shelf_of(struct resident_scene *scene, const struct shelf_kind *kind);

// Put a new thing on it, which it owns from now on. Nobody holds it yet.
void shelf_put(struct shelf *shelf, struct shelved *thing);

void shelf_hold(struct shelved *thing);

// Once for each shelf_hold. The thing may be gone afterwards.
void shelf_release(struct shelved *thing);

// Destroy the least recently held of those that nobody holds, if there are more than `kept`. False: there are not.
bool shelf_drop_idle(struct shelf *shelf, uint32_t kept);

#endif
