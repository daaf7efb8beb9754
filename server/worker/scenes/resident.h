// The worker's scenes. Each is a sealed blob that the front handed over, mapped and checked at its first use, with those of
// its sections in device memory that some plan has needed. Device's thread only.
//
// A request that edits its scene gets a variant: a resident_scene of its own. It shares with its base, the scene as loaded,
// everything that the edits leave alone, in host and in device memory. The base is not changed, and other jobs go on using
// it. Equal edits share a variant. LIMIT_VARIANTS variants stay while no job uses them.
#ifndef CANDIL_WORKER_RESIDENT_H
#define CANDIL_WORKER_RESIDENT_H

#include "candil.pb.h"
#include "server/scene/blob.h"
#include "server/worker/scenes/edit.h"
#include "server/worker/vk/buffer.h"
#include "shaders/shared/bindings.h"

// What a technique derives from a scene and keeps from job to job, such as buffers of another API or a shelf of voxels. The
// first member of the maker's own struct. The scene owns it.
struct derived {
	struct derived *next;
	const void *kind; // an address that only its maker has
	void (*destroy)(struct derived *derived); // free it, as the scene leaves the device
	bool (*trim)(struct derived *derived); // free some of what no job uses; false: there is none. NULL: there never is
	uint64_t (*bytes)(const struct derived *derived); // device memory that trim can free; without trim, all. NULL: 0
};

// A scene, or a variant of one. Owned by struct resident_scenes; jobs hold it from resident_acquire to resident_release.
struct resident_scene {
	struct resident_scene *next;
	uint64_t id;
	int fd; // of the blob
	const struct blob_header *blob; // NULL until the first use
	size_t bytes;
	struct resident_scene *base; // of a variant: the scene as loaded; NULL: this is one
	struct blob_view view; // what a job reads
	struct scene_keys keys; // of the view; what was derived from a part is good while that part's key stays
	struct edited edited; // of a variant, with the nodes that it moves; zeroed in a base
	uint8_t *edits; // of a variant: its edits, encoded
	size_t edit_bytes; // of `edits`
	uint64_t edit_hash; // of `edits`
	uint64_t edit_us; // of a variant: the time that applying its edits took
	bool edit_told; // some job has edit_us in its account
	struct buffer buffers[BIND_SCENE_COUNT]; // by binding; zeroed: not on the device, or the base's is used
	struct derived *derived; // newest first; destroyed before the buffers
	uint32_t jobs; // that use it; in a base, those of its variants too
	uint64_t used; // resident_scenes.turn when a job last began with it
	bool forgotten; // to be destroyed with its last job
};

// All scenes of the worker. Zeroed, with `device` set: none.
struct resident_scenes {
	struct device *device; // NULL: there is none, and nothing may be uploaded
	struct resident_scene *first;
	uint64_t turn; // counts resident_acquire
};

// Keep a scene under `id`. `fd`, its blob's memfd, is taken over, on failure too. STATUS_MEMORY.
enum status resident_add(struct resident_scenes *scenes, uint64_t id, int fd, struct error *err);

// Destroy a scene and its variants, at once or when its last job ends. Unknown ids are ignored.
void resident_forget(struct resident_scenes *scenes, uint64_t id);

// Find a scene for a job, mapped and checked, with the edits of its request applied (NULL, or none in it: as loaded). *scene
// is held until resident_release, which each success needs. Failures are those of mapping and checking the blob
// (memfd_map_sealed, blob_check) and of edit_apply; STATUS_INTERNAL for an unknown id. `err` must not be NULL.
enum status resident_acquire(struct resident_scenes *scenes, uint64_t id, const candil_Edits *edits,
			     struct resident_scene **scene, struct error *err);

// End a job's use of a scene. A forgotten scene is destroyed with its last job; variants beyond LIMIT_VARIANTS go.
void resident_release(struct resident_scenes *scenes, struct resident_scene *scene);

// The elements of a section as a job sees them: the edited ones where an edit changes the section, else those of the blob.
// Techniques read sections only through this and scene_count.
static inline const void *scene_section(const struct resident_scene *scene, enum blob_section section)
{
	return scene->view.sections[section];
}

// The number of those elements.
static inline uint32_t scene_count(const struct resident_scene *scene, enum blob_section section)
{
	return scene->view.counts[section];
}

// Whether a variant uses its base's buffer for this binding. False for a scene that is no variant.
bool resident_shares(const struct resident_scene *scene, uint32_t binding);

// The buffer to bind for a binding, the scene's own or its base's; zeroed if it is not on the device. It stays the scene's.
const struct buffer *resident_buffer(const struct resident_scene *scene, uint32_t binding);

// Upload those of these bindings (bits 1 << BIND_…) that are not on the device. Sections without elements stay off. Fails as
// buffer_init_with does; what has been uploaded by then stays.
enum status resident_upload(struct resident_scene *scene, struct device *device, uint32_t bindings, struct error *err);

// What a binding holds, in host memory: a section, or a table of the worker's own (sRGB's curve, GGX's albedos). It stays
// the scene's. *bytes is 0 for a section without elements.
const void *resident_data(const struct resident_scene *scene, uint32_t binding, uint64_t *bytes);

// Whether some texture of the scene is deep (TEXTURE_DEEP).
bool resident_has_deep_textures(const struct resident_scene *scene);

// What the maker with this kind has derived from the scene before; NULL: nothing.
struct derived *resident_derived(const struct resident_scene *scene, const void *kind);

// Give the scene something derived from it, which it owns from now on and destroys when it leaves the device.
void resident_derive(struct resident_scene *scene, struct derived *derived);

// Take the least recently used scene that no job uses off the device: a variant is destroyed, of a base the blob stays
// mapped. If all are in use, trim what techniques derived from them and no job uses. False: everything on the device is in
// use.
bool resident_evict(struct resident_scenes *scenes);

// Device memory, in bytes, that resident_evict would free if it were called until it returns false.
uint64_t resident_idle_bytes(const struct resident_scenes *scenes);

// Destroy all scenes. No job may use one.
void resident_finish(struct resident_scenes *scenes);

#endif
