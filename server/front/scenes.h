// The scenes that the daemon keeps, by name, and the loads that make them.
//
// A scene lives as long as it has users: the registry is one while the scene has its name, and so is each job that uses it.
// Unloading or replacing a scene takes its name away, and the blob goes with the last job. While a new scene of the same
// name is being loaded, the old one stays.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_SCENES_H
#define CANDIL_FRONT_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/front/loader.h"
#include "server/front/quarantine.h"

struct session;
struct scenes;

enum scene_state {
	SCENE_WAITING, // for a loader to become free
	SCENE_LOADING,
	SCENE_READY,
	SCENE_FAILED, // only seen by jobs that waited for it
};

// The registry's. Others may read what is above `source`, `next` too, and set `session` to NULL when the session goes.
struct scene {
	uint64_t id; // never used twice
	enum scene_state state;
	bool listed; // the name finds it
	unsigned users;
	int blob; // sealed memfd; -1: not loaded
	candil_SceneInfo info;
	struct scene_remarks remarks; // those that a render's reply passes over
	// the load under way
	struct session *session; // who asked; NULL: the daemon itself, or gone
	bool own; // the daemon itself asked
	uint32_t request;
	struct source source;
	candil_UpAxis up;
	double metres_per_unit;
	bool has_images; // so the loader said
	uint64_t asked_us;
	uint64_t started_us;
	bool had_turn; // it ran for LIMIT_LOAD_TURN_SECONDS while others waited
	bool in_long_place;
	struct loader loader;
	struct scenes *table;
	struct scene *next; // in the order of asking
};

// Calls from the registry to its owner. `failed` and `gone` may come from within the functions below.
struct scenes_events {
	// The load is done. scene->session, if there is one, waits for its reply.
	void (*ready)(void *owner, struct scene *scene);

	// The load failed, and `err` says why. scene->session, if there is one, waits for its reply. Jobs that wait for the
	// scene must give it back.
	void (*failed)(void *owner, struct scene *scene, const struct error *err);

	// The last user is gone, and the scene is freed after the call.
	void (*gone)(void *owner, struct scene *scene);
};

// Others may read `first` and the figures at the end.
struct scenes {
	struct children *children;
	const struct options *options;
	unsigned most; // with a name or being loaded
	const struct scenes_events *events;
	void *owner;
	struct scene *first; // in the order of asking
	uint64_t next_id;
	struct loop_timer turn; // the end of a load's turn that others wait for
	struct quarantine quarantine; // kept by the service, who blames scenes
	uint32_t loader_starts;
	uint64_t loader_failures;
};

// No scene yet. `options` are those of the loaders; `most` is how many scenes there may be, at most LIMIT_SCENES, and as
// many again may be kept by jobs alone. All four pointers must outlive it.
void scenes_init(struct scenes *scenes, struct children *children, const struct options *options, unsigned most,
		 const struct scenes_events *events, void *owner);

// Free all scenes and kill their loaders. No event is called; jobs must have given their scenes back.
void scenes_finish(struct scenes *scenes);

// Begin a load. `source` is taken over, on failure too. `session` NULL: the daemon itself asks. The answer comes by events,
// never before this returns. How large a scene is shows when it is loaded: one that is too much together with the others
// (LIMIT_SCENES_BYTES), or quarantined, fails then. Failures, without an event: STATUS_TOO_MANY_SCENES, STATUS_MEMORY, and
// STATUS_BAD_ARGUMENT if a load of that name is under way.
enum status scenes_load(struct scenes *scenes, const candil_Load *load, struct source *source, struct session *session,
			uint32_t request, struct error *err);

// Start the loads that wait while loaders are free. The service calls it once after each batch of events.
//
// A load that takes long never keeps one out that does not. LIMIT_LOADERS run at once. Where another waits that has not run
// yet, each has its place for LIMIT_LOAD_TURN_SECONDS; then it goes on in one more place, for long loads, and if that is
// taken, it is ended and begun again when no such other waits. Those that have not run yet come in the order of how many
// loads their peers have under way, then their connections, then of asking; those that are begun again in the order of
// asking.
void scenes_dispatch(struct scenes *scenes);

// The scene of a name: the ready one, else the one that is being loaded, else NULL. Good until the next call that may free
// scenes, unless it is held.
struct scene *scenes_find(struct scenes *scenes, const char *name);

// The load that a session's request is waiting for; NULL if there is none.
struct scene *scenes_find_load(struct scenes *scenes, const struct session *session, uint32_t request);

// End a load that is under way: `failed` is called with `err`. Without other users the scene is freed.
void scenes_stop_load(struct scene *scene, const struct error *err);

// Take away the name; a load that is under way ends with STATUS_CANCELLED. Without other users the scene is freed.
void scenes_unload(struct scene *scene);

// Be a user of the scene, or no longer. The scene is freed with its last user, and `gone` is called.
void scene_hold(struct scene *scene);
void scene_release(struct scene *scene);

// How many scenes are ready and have their name. *bytes: the blobs of all scenes, those included that only jobs still use.
uint32_t scenes_count(const struct scenes *scenes, uint64_t *bytes);

// The process of a load that is under way; 0 if there is none.
pid_t scenes_loader_pid(const struct scenes *scenes);

#endif
