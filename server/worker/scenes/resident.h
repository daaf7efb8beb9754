// Scenes in the worker: each a sealed blob that the front handed over, mapped and checked at its first use, and those of
// its sections that some plan needed, in device memory. Device's thread only.
//
// A request that edits its scene gets a variant: a resident_scene of its own that shares with its base, the scene as loaded,
// all that the edits leave alone, in host and in device memory. The base is untouched and others go on using it. Equal edits
// share a variant; LIMIT_VARIANTS stay while no job uses them.
#ifndef CANDIL_WORKER_RESIDENT_H
#define CANDIL_WORKER_RESIDENT_H

#include "candil.pb.h"
#include "server/scene/blob.h"
#include "server/worker/scenes/edit.h"
#include "server/worker/vk/buffer.h"
#include "shaders/shared/bindings.h"

// What a technique made out of a scene and keeps from job to job: another API's buffers, voxels. First member of the
// technique's own struct.
struct derived {
	struct derived *next;
	const void *kind; // the address of something that only its maker has
	void (*destroy)(struct derived *derived);
	bool (*trim)(struct derived *derived); // free some of what no job uses; false: there is none. NULL: never any
	uint64_t (*bytes)(const struct derived *derived); // device memory that no job uses; without trim, all. NULL: none
};

struct resident_scene {
	struct resident_scene *next;
	uint64_t id;
	int fd; // of the blob
	const struct blob_header *blob; // NULL until the first use
	size_t bytes;
	struct resident_scene *base; // of a variant: the scene as it was loaded; else NULL
	struct blob_view view; // what a job reads
	struct scene_keys keys; // of what it reads; a technique may keep what it derived for as long as they stay
	struct edited edited; // of a variant; zeroed in a base. Its moves are what moved
	uint8_t *edits; // of a variant: the edits, encoded; `edit_bytes` of them
	size_t edit_bytes;
	uint64_t edit_hash; // of them
	uint64_t edit_us; // of a variant: what it took to make…
	bool edit_told; // …and whether a job has that in its account
	struct buffer buffers[BIND_SCENE_COUNT]; // by binding; zeroed: not on the device, or the base's is used
	struct derived *derived; // newest first; they go before the buffers
	uint32_t jobs; // that use it; a base's variants' jobs count
	uint64_t used; // when a job last began with it, in turns of resident_scenes.turn
	bool forgotten; // goes with its last job
};

struct resident_scenes {
	struct device *device;
	struct resident_scene *first;
	uint64_t turn;
};

// Keep a scene under `id`. Takes fd.
enum status resident_add(struct resident_scenes *scenes, uint64_t id, int fd, struct error *err);

// Let it go: now, or when its last job ends. Unknown ids are ignored.
void resident_forget(struct resident_scenes *scenes, uint64_t id);

// Find a scene for a job, mapped and checked, with the edits of its request (NULL, or none in it: as loaded). Each success
// is paired with resident_release. STATUS_BAD_ARGUMENT as edit_apply has it.
enum status resident_acquire(struct resident_scenes *scenes, uint64_t id, const candil_Edits *edits,
			     struct resident_scene **scene, struct error *err);
void resident_release(struct resident_scenes *scenes, struct resident_scene *scene);

// What a job's scene holds: its own where an edit put something in its place, else as loaded. Techniques read no section in
// any other way.
static inline const void *scene_section(const struct resident_scene *scene, enum blob_section section)
{
	return scene->view.sections[section];
}

static inline uint32_t scene_count(const struct resident_scene *scene, enum blob_section section)
{
	return scene->view.counts[section];
}

// Whether an edited scene has this binding of its base, and no buffer of its own for it.
bool resident_shares(const struct resident_scene *scene, uint32_t binding);

// The buffer to bind; zeroed if it is not on the device.
const struct buffer *resident_buffer(const struct resident_scene *scene, uint32_t binding);

// Bring these bindings (bits 1 << BIND_…) onto the device, those that are not there yet. Sections without elements stay off.
enum status resident_upload(struct resident_scene *scene, struct device *device, uint32_t bindings, struct error *err);

// What a binding holds, in host memory: a section of the blob, or a table of ours. bytes is 0 for a section without
// elements.
const void *resident_data(const struct resident_scene *scene, uint32_t binding, uint64_t *bytes);

// What a maker derived before, or NULL; and handing something over, to be destroyed with the scene or when it leaves the
// device.
struct derived *resident_derived(const struct resident_scene *scene, const void *kind);
void resident_derive(struct resident_scene *scene, struct derived *derived);

// Take the least recently used scene that no job needs off the device; its blob stays mapped, a variant goes altogether. If
// there is none, what techniques derived from the others and no job uses. False: all that is on the device is in use.
bool resident_evict(struct resident_scenes *scenes);

// Device memory that calls of resident_evict would make free, if it were called until there is no more.
uint64_t resident_idle_bytes(const struct resident_scenes *scenes);

void resident_finish(struct resident_scenes *scenes);

#endif
