#include "server/front/scenes.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/limits.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/session.h"

void scenes_init(struct scenes *scenes, struct children *children, const struct options *options, unsigned most,
		 const struct scenes_events *events, void *owner)
{
	*scenes = (struct scenes){
	    .children = children, .options = options, .most = most, .events = events, .owner = owner, .next_id = 1};
}

static bool is_loading(const struct scene *scene)
{
	return scene->state == SCENE_WAITING || scene->state == SCENE_LOADING;
}

static void scene_destroy(struct scene *scene)
{
	loader_stop(&scene->loader);
	source_close(&scene->source);
	if (scene->blob >= 0)
		close(scene->blob);
	free(scene);
}

void scenes_finish(struct scenes *scenes)
{
	loop_timer_stop(scenes->children->loop, &scenes->turn);
	while (scenes->first) {
		struct scene *s = scenes->first;
		scenes->first = s->next;
		scene_destroy(s);
	}
}

void scene_hold(struct scene *scene)
{
	scene->users++;
}

void scene_release(struct scene *scene)
{
	if (--scene->users > 0)
		return;
	struct scenes *table = scene->table;
	for (struct scene **link = &table->first; *link; link = &(*link)->next)
		if (*link == scene) {
			*link = scene->next;
			break;
		}
	table->events->gone(table->owner, scene);
	scene_destroy(scene);
}

static void scene_unlist(struct scene *scene)
{
	if (!scene->listed)
		return;
	scene->listed = false;
	scene_release(scene);
}

static struct scene *scenes_find_state(struct scenes *scenes, const char *name, bool loading)
{
	for (struct scene *s = scenes->first; s; s = s->next)
		if (s->listed && is_loading(s) == loading && !strcmp(s->info.name, name))
			return s;
	return NULL;
}

struct scene *scenes_find(struct scenes *scenes, const char *name)
{
	struct scene *ready = scenes_find_state(scenes, name, false);
	return ready ? ready : scenes_find_state(scenes, name, true);
}

struct scene *scenes_find_load(struct scenes *scenes, const struct session *session, uint32_t request)
{
	for (struct scene *s = scenes->first; s; s = s->next)
		if (s->listed && is_loading(s) && s->session == session && s->request == request)
			return s;
	return NULL;
}

void scenes_stop_load(struct scene *scene, const struct error *err)
{
	struct scenes *table = scene->table;
	scene_hold(scene);
	loader_stop(&scene->loader);
	scene->state = SCENE_FAILED;
	table->loader_failures += err->code != STATUS_CANCELLED && err->code != STATUS_SHUTTING_DOWN;
	log_line(LOG_WARNING, "scene \"%s\": load failed: %s: %s", scene->info.name, status_name(err->code), err->text);
	table->events->failed(table->owner, scene, err);
	scene->session = NULL;
	scene_unlist(scene);
	scene_release(scene);
}

void scenes_unload(struct scene *scene)
{
	struct error err;
	if (is_loading(scene)) {
		error_set(&err, STATUS_CANCELLED, "the scene was unloaded while it was being loaded");
		scenes_stop_load(scene, &err);
		return;
	}
	log_line(LOG_INFO, "scene \"%s\": unloaded", scene->info.name);
	scene_unlist(scene);
}

// Keep what the loader found, and add what only the front knows.
static void scene_keep(struct scene *scene, const struct ipc_loaded *message, int blob)
{
	char name[sizeof scene->info.name];
	memcpy(name, scene->info.name, sizeof name);
	scene->info = message->info;
	scene->remarks = message->remarks;
	memcpy(scene->info.name, name, sizeof name);
	scene->info.load_us = clock_us() - scene->asked_us;
	scene->blob = blob;
	source_close(&scene->source);
}

// Check that a new scene and all others together are not too large. The scene that it replaces does not count, unless jobs
// still use it.
static enum status check_bytes(const struct scenes *scenes, const struct scene *old, uint64_t bytes, struct error *err)
{
	uint64_t others;
	scenes_count(scenes, &others);
	if (old && old->users == 1)
		others -= old->info.blob_bytes;
	if (others + bytes <= LIMIT_SCENES_BYTES)
		return STATUS_OK;
	return error_set(err, STATUS_TOO_MANY_SCENES,
			 "the scene takes %llu MiB, the others %llu, all together may take %llu: unload some first",
			 (unsigned long long)bytes >> 20, (unsigned long long)others >> 20, LIMIT_SCENES_BYTES >> 20);
}

static void start_loader(struct scene *scene)
{
	struct error err;
	scene->state = SCENE_LOADING;
	if (loader_start(&scene->loader, &scene->source, scene->up, scene->metres_per_unit, scene->has_images, &err) !=
	    STATUS_OK)
		scenes_stop_load(scene, &err);
}

static void scene_loaded(void *owner, const struct ipc_loaded *message, int blob)
{
	struct scene *scene = owner;
	struct scenes *table = scene->table;
	if (message->error.code != STATUS_OK && message->wants_images && !scene->has_images) {
		scene->has_images = true;
		start_loader(scene);
		return;
	}
	if (message->error.code != STATUS_OK) {
		scenes_stop_load(scene, &message->error);
		return;
	}
	struct scene *old = scenes_find_state(table, scene->info.name, false);
	struct error err;
	struct subject_hashes suspects = {0};
	memcpy(suspects.part[PART_SCENE], message->info.hash, sizeof suspects.part[PART_SCENE]);
	if (quarantine_check(&table->quarantine, &suspects, &err) != STATUS_OK ||
	    check_bytes(table, old, message->info.blob_bytes, &err) != STATUS_OK) {
		close(blob);
		scenes_stop_load(scene, &err);
		return;
	}
	scene_keep(scene, message, blob);
	scene->state = SCENE_READY;
	if (old)
		scene_unlist(old);
	log_line(LOG_INFO, "scene \"%s\": loaded, %u triangles, %llu bytes, %llu ms", scene->info.name,
		 scene->info.triangles, (unsigned long long)scene->info.blob_bytes,
		 (unsigned long long)scene->info.load_us / 1000);
	table->events->ready(table->owner, scene);
	scene->session = NULL;
}

static enum status may_load(struct scenes *scenes, const char *name, struct error *err)
{
	unsigned listed = 0, all = 0;
	for (const struct scene *s = scenes->first; s; s = s->next, all++)
		listed += s->listed;
	if (scenes_find_state(scenes, name, true))
		return error_set(err, STATUS_BAD_ARGUMENT, "a scene of that name is being loaded: wait, or unload it first");
	if (listed >= scenes->most)
		return error_set(err, STATUS_TOO_MANY_SCENES, "%u scenes are there: unload one first", listed);
	if (all >= 2 * scenes->most)
		return error_set(err, STATUS_TOO_MANY_SCENES,
				 "%u scenes without a name are still in use by jobs: wait for some of these to end",
				 all - listed);
	return STATUS_OK;
}

enum status scenes_load(struct scenes *scenes, const candil_Load *load, struct source *source, struct session *session,
			uint32_t request, struct error *err)
{
	enum status status = may_load(scenes, load->name, err);
	struct scene *s = status == STATUS_OK ? calloc(1, sizeof *s) : NULL;
	if (!s) {
		source_close(source);
		return status != STATUS_OK ? status : error_set(err, STATUS_MEMORY, "no memory for one more scene");
	}
	s->id = scenes->next_id++;
	s->state = SCENE_WAITING;
	s->listed = true;
	s->users = 1;
	s->blob = -1;
	memcpy(s->info.name, load->name, sizeof s->info.name);
	s->session = session;
	s->own = !session;
	s->request = request;
	s->source = *source;
	source->folder = -1;
	s->up = load->up;
	s->metres_per_unit = load->metres_per_unit;
	s->asked_us = clock_us();
	s->table = scenes;
	loader_init(&s->loader, scenes->children, scenes->options, scene_loaded, s);
	struct scene **link = &scenes->first;
	while (*link)
		link = &(*link)->next;
	*link = s;
	return STATUS_OK;
}

static const struct peer *peer_of(const struct scene *scene)
{
	return scene->session ? scene->session->peer : NULL;
}

// Loads under way of the peer that asked for this one, as a number that counts those of its connection in second place.
static unsigned loads_beside(const struct scenes *scenes, const struct scene *scene)
{
	unsigned count = 0;
	for (const struct scene *s = scenes->first; s; s = s->next)
		if (s->state == SCENE_LOADING || (s->state == SCENE_WAITING && s->had_turn))
			count += (peer_of(s) == peer_of(scene) ? LIMIT_SCENES * 2 : 0) + (s->session == scene->session);
	return count;
}

// The load whose turn is next among those that had none yet: of the peer that has the fewest under way, of its
// connection that has, the oldest.
static struct scene *next_fresh(struct scenes *scenes)
{
	struct scene *next = NULL;
	unsigned least = 0;
	for (struct scene *s = scenes->first; s; s = s->next) {
		const bool waits = s->state == SCENE_WAITING && !s->had_turn;
		const unsigned beside = waits ? loads_beside(scenes, s) : 0;
		if (!waits || (next && beside >= least))
			continue;
		next = s;
		least = beside;
	}
	return next;
}

static struct scene *next_long(struct scenes *scenes)
{
	struct scene *s = scenes->first;
	while (s && !(s->state == SCENE_WAITING && s->had_turn))
		s = s->next;
	return s;
}

static uint64_t turn_end(const struct scene *scene)
{
	return scene->had_turn ? 0 : scene->started_us + LIMIT_LOAD_TURN_SECONDS * 1000000ull;
}

// The load whose turn ends first of those that are not in the place for long ones.
static struct scene *next_to_yield(struct scenes *scenes)
{
	struct scene *first = NULL;
	for (struct scene *s = scenes->first; s; s = s->next)
		if (s->state == SCENE_LOADING && !s->in_long_place && (!first || turn_end(s) < turn_end(first)))
			first = s;
	return first;
}

// How many loads run, and whether one more may be started.
struct places {
	unsigned running;
	bool long_is_taken, may_start;
};

static struct places places_of(const struct scenes *scenes)
{
	struct places p = {0};
	for (const struct scene *s = scenes->first; s; s = s->next) {
		p.running += s->state == SCENE_LOADING;
		p.long_is_taken |= s->state == SCENE_LOADING && s->in_long_place;
	}
	// A load may leave two behind: a loader that wants images is started a second time.
	p.may_start = p.running <= LIMIT_LOADERS && scenes->children->count + 2 * (p.running + 1) <= LIMIT_CHILDREN_LEFT;
	return p;
}

static void begin(struct scenes *scenes, struct scene *scene, bool in_long_place)
{
	scenes->loader_starts += !scene->had_turn;
	scene->started_us = clock_us();
	scene->in_long_place = in_long_place;
	start_loader(scene);
}

static void look_again(void *owner)
{
	(void)owner; // the service dispatches after this
}

// Have a load make room for one that had no turn yet. False, with the timer set, if it still has its turn.
static bool yield_place(struct scenes *scenes, struct scene *scene, const struct places *places)
{
	if (clock_us() < turn_end(scene)) {
		loop_timer_set(scenes->children->loop, &scenes->turn, turn_end(scene), look_again, scenes);
		return false;
	}
	scene->had_turn = true;
	if (!places->long_is_taken) {
		scene->in_long_place = true;
		return true;
	}
	log_line(LOG_INFO, "scene \"%s\": begun again later, others wait", scene->info.name);
	loader_stop(&scene->loader);
	scene->state = SCENE_WAITING;
	return true;
}

// Start one load, or make room for one. False if there is nothing to do.
static bool dispatch_one(struct scenes *scenes)
{
	const struct places places = places_of(scenes);
	struct scene *fresh = next_fresh(scenes), *old = fresh ? NULL : next_long(scenes);
	if (old && places.may_start) {
		begin(scenes, old, !places.long_is_taken);
		return true;
	}
	if (!fresh)
		return false;
	if (places.running - places.long_is_taken >= LIMIT_LOADERS)
		return yield_place(scenes, next_to_yield(scenes), &places);
	if (places.may_start)
		begin(scenes, fresh, false);
	return places.may_start;
}

void scenes_dispatch(struct scenes *scenes)
{
	while (dispatch_one(scenes))
		;
}

uint32_t scenes_count(const struct scenes *scenes, uint64_t *bytes)
{
	uint32_t count = 0;
	*bytes = 0;
	for (const struct scene *s = scenes->first; s; s = s->next) {
		count += s->listed && s->state == SCENE_READY;
		*bytes += s->info.blob_bytes;
	}
	return count;
}

pid_t scenes_loader_pid(const struct scenes *scenes)
{
	for (const struct scene *s = scenes->first; s; s = s->next)
		if (s->state == SCENE_LOADING && s->loader.child.pid > 0)
			return s->loader.child.pid;
	return 0;
}
