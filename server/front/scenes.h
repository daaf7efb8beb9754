// The scenes that the daemon keeps, by name, and the loads that make them.
//
// A scene is counted by who uses it: the registry while its name is taken, and each job. Unloading or replacing takes the
// name away; the blob goes with the last job. While a new scene of the same name loads, the old one stays.
#ifndef CANDIL_FRONT_SCENES_H
#define CANDIL_FRONT_SCENES_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/front/loader.h"

struct session;
struct scenes;

enum scene_state {
	SCENE_WAITING, // for a loader to become free
	SCENE_LOADING,
	SCENE_READY,
	SCENE_FAILED, // only seen by jobs that waited for it
};

struct scene {
	uint64_t id; // never used twice
	enum scene_state state;
	bool listed; // the name finds it
	unsigned users;
	int blob; // sealed memfd; -1: not loaded
	candil_SceneInfo info;
	// the load under way
	struct session *session; // who asked; NULL: the daemon itself, or gone
	bool own; // the daemon itself asked
	uint32_t request;
	struct source source;
	candil_UpAxis up;
	double metres_per_unit;
	uint64_t asked_us;
	struct loader loader;
	struct scenes *table;
	struct scene *next; // in the order of asking
};

// Calls from the registry to its owner.
struct scenes_events {
	void (*ready)(void *owner, struct scene *scene);
	// The load failed; err says why. Jobs that wait for the scene must give it back.
	void (*failed)(void *owner, struct scene *scene, const struct error *err);
	// The last user is gone; the scene is freed after the call.
	void (*gone)(void *owner, struct scene *scene);
};

struct scenes {
	struct children *children;
	const char *libexec;
	const struct scenes_events *events;
	void *owner;
	struct scene *first;
	uint64_t next_id;
	uint32_t loader_starts;
	uint64_t loader_failures;
};

void scenes_init(struct scenes *scenes, struct children *children, const char *libexec, const struct scenes_events *events,
		 void *owner);
void scenes_finish(struct scenes *scenes);

// Begin a load. `source` is taken over, on failure too. `session` may be NULL. The answer comes by events, never before
// this returns. STATUS_TOO_MANY_SCENES; STATUS_BAD_ARGUMENT if a load of that name is under way. How large a scene is shows
// when it is loaded: one that is too much together with the others (LIMIT_SCENES_BYTES) fails then.
enum status scenes_load(struct scenes *scenes, const candil_Load *load, struct source *source, struct session *session,
			uint32_t request, struct error *err);

// Start waiting loads while loaders are free. Called from settle.
void scenes_dispatch(struct scenes *scenes);

// By name: the ready one, else the one that is loading, else NULL.
struct scene *scenes_find(struct scenes *scenes, const char *name);

// The load that a session's request is waiting for; NULL if none.
struct scene *scenes_find_load(struct scenes *scenes, const struct session *session, uint32_t request);

// End a load that is under way: `failed` is called with err.
void scenes_stop_load(struct scene *scene, const struct error *err);

// Take away the name; a load under way ends with STATUS_CANCELLED.
void scenes_unload(struct scene *scene);

void scene_hold(struct scene *scene);
void scene_release(struct scene *scene);

// Listed and ready ones; the bytes of all, with those that jobs still use.
uint32_t scenes_count(const struct scenes *scenes, uint64_t *bytes);

// Of a load under way, else 0.
pid_t scenes_loader_pid(const struct scenes *scenes);

#endif
