// Design note. Callbacks change states and queue replies. service_settle alone, between two batches of events, gives orders
// to loaders and worker, sends what waits and frees the sessions that have ended. So no callback finds its own session freed
// by what it called, and each batch of events costs one look at everything.
#include "server/front/service.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/dispatch.h"
#include "server/front/fence.h"
#include "server/front/reply.h"
#include "server/front/share.h"
#include "server/front/state.h"
#include "server/front/warm.h"

#define ACCEPTS_PER_TURN 16u
#define ACCEPT_PAUSE_US 100000u

// ---- connections -----------------------------------------------------------------------------------------------------

// Tell a peer why it is not served. It gets a session that does nothing but send this and close. So that none has to wait
// for its word behind those who are slow to take theirs, one of the places is for those who are told without being waited
// for.
static void turn_away(struct service *service, struct channel *channel, const struct error *err)
{
	struct sessions *sessions = &service->sessions;
	struct session *session;
	const unsigned own = sessions_of(sessions, channel->peer, true), all = sessions->turned_away;
	const bool waits = all < LIMIT_TURNED_AWAY - 1 && share_allows(own, 1, LIMIT_TURNED_AWAY - 1 - all);
	if (waits)
		log_line(LOG_WARNING, "connection refused: %s", err->text);
	if (session_create(sessions, channel, &session, NULL) != STATUS_OK)
		return;
	session->turned_away = true;
	session->curt = !waits;
	sessions->turned_away++;
	reply_error(session, 0, err);
	session_close(session);
}

static void accept_again(void *owner)
{
	struct service *service = owner;
	service->listener->kind->pause(service->listener, false);
}

// Whoever comes meanwhile waits in the socket's queue. The listener stays ready: without a pause the loop would spin.
static void accept_later(struct service *service)
{
	service->listener->kind->pause(service->listener, true);
	loop_timer_set(service->loop, &service->accept_pause, clock_us() + ACCEPT_PAUSE_US, accept_again, service);
}

// May the peer be served? What is against it goes to `err`.
static enum status may_connect(const struct service *service, const struct channel *channel, struct error *err)
{
	const unsigned most = service->capacity.connections;
	const unsigned count = service->sessions.count - service->sessions.turned_away;
	const unsigned own = sessions_of(&service->sessions, channel->peer, false);
	if (!channel->kind->peer_allowed(channel))
		return error_set(err, STATUS_NOT_ALLOWED, "this daemon serves its own user and root alone");
	if (count >= most)
		return error_set(err, STATUS_TOO_MANY_CONNECTIONS,
				 "there are %u connections, no more may be: try again later", count);
	if (!share_allows(own, 1, most - count))
		return error_set(err, STATUS_TOO_MANY_CONNECTIONS,
				 "of %u connections this process has %u, the others are kept for others: close some", most,
				 own);
	return STATUS_OK;
}

static void accept_some(void *owner, uint32_t events)
{
	struct service *service = owner;
	struct listener *listener = service->listener;
	(void)events;
	for (unsigned i = 0; i < ACCEPTS_PER_TURN; i++) {
		struct session *session;
		struct channel channel;
		struct error err;
		// The last place is free again in the next turn.
		if (service->sessions.turned_away >= LIMIT_TURNED_AWAY)
			return;
		const enum listener_result result = listener->kind->accept(listener, &channel);
		if (result == LISTENER_EXHAUSTED) {
			log_line(LOG_WARNING, "no descriptor or memory is left to accept a connection: it waits");
			accept_later(service);
		}
		if (result != LISTENER_ACCEPTED)
			return;
		if (may_connect(service, &channel, &err) != STATUS_OK)
			turn_away(service, &channel, &err);
		else if (session_create(&service->sessions, &channel, &session, &err) != STATUS_OK)
			log_line(LOG_ERROR, "connection lost: %s", err.text);
	}
}

static void on_session_message(void *owner, struct session *session, const struct header *header, const uint8_t *body)
{
	dispatch_message(owner, session, header, body);
}

static bool on_session_fill(void *owner, struct session *session)
{
	struct service *service = owner;
	return jobs_fill(&service->jobs, session);
}

static void on_session_refused(void *owner, struct session *session, uint32_t request, const struct error *err)
{
	(void)owner;
	reply_error(session, request, err);
}

static void on_session_ended(void *owner, struct session *session)
{
	struct service *service = owner;
	struct error err;
	error_set(&err, STATUS_CANCELLED, "the client that loaded the scene went before it was there: load it again");
	jobs_fail_all(&service->jobs, session, NULL);
	quotes_drop_session(&service->quotes, session);
	for (struct scene *s = service->scenes.first, *next; s; s = next) {
		next = s->next;
		if (s->session != session)
			continue;
		s->session = NULL;
		scenes_stop_load(s, &err);
		next = service->scenes.first; // the list has changed: from the beginning once more
	}
	if (session == service->warming)
		service->warming = NULL;
	else if (service->options->private_fd >= 0)
		service->stop = true;
}

static const struct session_events session_events = {
    .message = on_session_message, .fill = on_session_fill, .refused = on_session_refused, .ended = on_session_ended};

// ---- scenes ----------------------------------------------------------------------------------------------------------

static void fail_quarantined(struct service *service)
{
	jobs_fail_quarantined(&service->jobs, &service->scenes.quarantine);
	quotes_fail_quarantined(&service->quotes, &service->scenes.quarantine);
}

static void on_scene_ready(void *owner, struct scene *scene)
{
	struct service *service = owner;
	worker_scene(&service->worker, scene->id, scene->blob);
	if (scene->session) {
		scene->session->requests--;
		reply_message(scene->session, MESSAGE_SCENE_INFO, scene->request, candil_SceneInfo_fields, &scene->info);
	}
	fail_quarantined(service); // what it is shows only now
}

static void on_scene_failed(void *owner, struct scene *scene, const struct error *err)
{
	struct service *service = owner;
	if (scene->session) {
		scene->session->requests--;
		reply_error(scene->session, scene->request, err);
	}
	jobs_fail_scene(&service->jobs, scene, err);
	quotes_fail_scene(&service->quotes, scene, err);
	// Whoever names a scene on the command line counts on it, so the daemon does not go on without it.
	if (scene->own && !service->leaving && err->code != STATUS_CANCELLED)
		error_set(&service->own_failure, err->code, "scene %s: %s", scene->info.name, err->text);
}

static void on_scene_gone(void *owner, struct scene *scene)
{
	struct service *service = owner;
	if (scene->blob >= 0)
		worker_forget(&service->worker, scene->id);
}

static const struct scenes_events scenes_events = {
    .ready = on_scene_ready, .failed = on_scene_failed, .gone = on_scene_gone};

// ---- the worker ------------------------------------------------------------------------------------------------------

static void on_worker_ready(void *owner)
{
	struct service *service = owner;
	for (struct scene *s = service->scenes.first; s; s = s->next)
		if (s->blob >= 0)
			worker_scene(&service->worker, s->id, s->blob);
}

static void on_worker_begun(void *owner, uint32_t job, const struct ipc_begun *begun)
{
	struct service *service = owner;
	jobs_begun(&service->jobs, job, begun);
}

static void on_worker_stepped(void *owner, uint32_t job, const struct ipc_stepped *stepped)
{
	struct service *service = owner;
	jobs_stepped(&service->jobs, job, stepped);
}

static void on_worker_image(void *owner, uint32_t job, const struct ipc_image *image, int fd)
{
	struct service *service = owner;
	jobs_image(&service->jobs, job, image, fd);
}

static void on_worker_piloted(void *owner, uint32_t pilot, const struct ipc_piloted *piloted)
{
	struct service *service = owner;
	quotes_piloted(&service->quotes, pilot, piloted);
}

// Whose fault is it? What a driver tells is the device's. A crash or a hang may be the device's or that of what was worked
// on: it counts for the scene and the picture around it, and for the device unless the scene has ended a worker before. A
// picture that many put around their scenes is no excuse for a device that fails under each of them.
// What a device was given up over has had its share in that.
static void blame(struct service *service, const struct subject_hashes *suspects, enum worker_fault fault)
{
	static const char *const names[PARTS] = {
	    [PART_SCENE] = "scene", [PART_ENVIRONMENT] = "surroundings", [PART_IMPORTED] = "imported file"};
	struct quarantine *quarantine = &service->scenes.quarantine;
	struct error err;
	bool by_scene = fault == FAULT_WORK;
	if (fault == FAULT_NONE)
		return;
	if (fault == FAULT_DEVICE || !quarantine_knows(quarantine, suspects->part[PART_SCENE]))
		by_scene |= worker_blame_device(&service->worker);
	if (!by_scene)
		return;
	quarantine_blame(quarantine, suspects);
	if (quarantine_check(quarantine, suspects, &err) == STATUS_OK)
		return;
	for (unsigned i = 0; i < PARTS; i++)
		if (suspects->part[i][0])
			log_line(LOG_ERROR, "%s of hash %s: %s", names[i], suspects->part[i], err.text);
	fail_quarantined(service);
}

static void on_worker_lost(void *owner, const struct worker_loss *loss)
{
	struct service *service = owner;
	struct subject_hashes suspects;
	if (!quotes_worked_on(&service->quotes, &suspects))
		suspects = jobs_worked_on(&service->jobs);
	jobs_worker_lost(&service->jobs, loss);
	quotes_worker_lost(&service->quotes, loss->hopeless);
	blame(service, &suspects, loss->fault);
}

static const struct worker_events worker_events = {.ready = on_worker_ready,
						   .begun = on_worker_begun,
						   .stepped = on_worker_stepped,
						   .image = on_worker_image,
						   .piloted = on_worker_piloted,
						   .lost = on_worker_lost};

// ---- life ------------------------------------------------------------------------------------------------------------

static void stop_now(void *owner)
{
	struct service *service = owner;
	service->stop = true;
}

static void do_nothing(void *owner)
{
	(void)owner;
}

static enum status open_door(struct service *service, struct error *err)
{
	const struct options *o = service->options;
	struct session *session;
	struct channel channel;
	enum status status;
	if (o->private_fd >= 0) {
		status = channel_unix_adopt(&channel, service->loop, o->private_fd, err);
		return status == STATUS_OK ? session_create(&service->sessions, &channel, &session, err) : status;
	}
	status = channel_unix_listen(&service->listener, service->loop, o->socket, accept_some, service, err);
	if (status == STATUS_OK)
		log_line(LOG_INFO, "listening at %s", o->socket);
	return status;
}

// The door is open: no other will be.
static void stop_sockets(struct service *service)
{
	front_fence_stop_sockets(&service->fence);
	fence_log(&service->fence);
}

static void close_door(struct service *service)
{
	if (service->listener)
		service->listener->kind->close(service->listener);
	service->listener = NULL;
}

// End all requests, tell every client, those without a request under id 0, give them LIMIT_LINGER_MS to read it, and stop.
static void service_leave(struct service *service)
{
	struct error err;
	log_line(LOG_INFO, "shutting down");
	if (service->listener)
		accept_some(service, 0); // who has just connected is told, too
	service->leaving = true;
	loop_timer_stop(service->loop, &service->accept_pause);
	close_door(service);
	error_set(&err, STATUS_SHUTTING_DOWN, "the daemon is shutting down");
	jobs_fail_all(&service->jobs, NULL, &err);
	quotes_fail_all(&service->quotes, &err);
	while (service->scenes.first)
		if (service->scenes.first->state == SCENE_READY)
			scenes_unload(service->scenes.first);
		else
			scenes_stop_load(service->scenes.first, &err);
	worker_finish(&service->worker);
	for (struct session *s = service->sessions.first; s; s = s->next) {
		if (s->state < SESSION_FLUSHING)
			reply_error(s, 0, &err);
		session_close(s);
	}
	loop_timer_set(service->loop, &service->departure, clock_us() + LIMIT_LINGER_MS * 1000ull, stop_now, service);
}

static void service_settle(void *owner)
{
	struct service *service = owner;
	sessions_flush(&service->sessions);
	if (!service->leaving) {
		scenes_dispatch(&service->scenes);
		quotes_dispatch(&service->quotes);
		jobs_dispatch(&service->jobs);
	}
	if (!service->leaving && service->own_failure.code == STATUS_OK && warm_is_done(service) &&
	    open_door(service, &service->own_failure) == STATUS_OK)
		stop_sockets(service);
	if (service->own_failure.code != STATUS_OK && !service->leaving)
		service_leave(service);
	// Now that some was sent, more may be sent or read: the loop is to settle again without waiting for an event.
	if (sessions_flush(&service->sessions))
		loop_timer_set(service->loop, &service->again, 0, do_nothing, service);
	sessions_sweep(&service->sessions);
	if (service->leaving && service->sessions.count == 0)
		service->stop = true;
}

static void signalled(void *owner, uint32_t events)
{
	struct service *service = owner;
	struct signalfd_siginfo info;
	(void)events;
	if (read(service->signal_fd, &info, sizeof info) != (ssize_t)sizeof info)
		return;
	if (info.ssi_signo == SIGHUP) {
		log_line(LOG_INFO, "SIGHUP: there is no configuration to read again; SIGTERM ends the daemon");
	} else if (service->leaving) {
		log_line(LOG_INFO, "a second signal: ending at once");
		service->stop = true;
	} else {
		service_leave(service);
	}
}

static enum status watch_signals(struct service *service, struct error *err)
{
	sigset_t set;
	sigemptyset(&set);
	sigaddset(&set, SIGTERM);
	sigaddset(&set, SIGINT);
	sigaddset(&set, SIGHUP); // of a terminal that closes, which is no reason to end
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN); // what is learned may not fit, which the log tells
	// A parent may have left SIGCHLD ignored. Then the kernel would collect our children itself and give their numbers
	// away.
	signal(SIGCHLD, SIG_DFL);
	if (sigprocmask(SIG_BLOCK, &set, NULL) != 0)
		return error_errno(err, STATUS_INTERNAL, "cannot block signals");
	service->signal_fd = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
	if (service->signal_fd < 0)
		return error_errno(err, STATUS_INTERNAL, "cannot wait for signals");
	return loop_watch(service->loop, service->signal_fd, EPOLLIN, signalled, service, err);
}

static enum status open_root(struct service *service, struct error *err)
{
	const char *root = service->options->scene_root;
	if (!root)
		return STATUS_OK;
	service->scene_root = open(root, O_PATH | O_DIRECTORY | O_CLOEXEC);
	if (service->scene_root < 0)
		return error_errno(err, STATUS_SCENE_PATH, "cannot open --scene-root %.100s", root);
	return STATUS_OK;
}

static enum status load_own_scenes(struct service *service, struct error *err)
{
	for (unsigned i = 0; i < service->options->scene_count; i++) {
		const struct scene_option *option = &service->options->scenes[i];
		candil_Load load = {.metres_per_unit = 1};
		struct source source;
		memcpy(load.name, option->name, sizeof load.name);
		enum status status = source_own(&source, option->file, err);
		if (status == STATUS_OK)
			status = scenes_load(&service->scenes, &load, &source, NULL, 0, err);
		if (status != STATUS_OK)
			return status;
	}
	return STATUS_OK;
}

static bool wants_warmth(const struct options *o)
{
	for (unsigned i = 0; i < o->scene_count; i++)
		if (o->scenes[i].warm)
			return true;
	return false;
}

static enum status set_up(struct service *service, struct error *err)
{
	enum status status = capacity_init(&service->capacity, err);
	if (status == STATUS_OK)
		status = loop_create(&service->loop, err);
	if (status != STATUS_OK)
		return status;
	// First: until then a signal ends the process as it stands.
	status = watch_signals(service, err);
	children_init(&service->children, service->loop);
	sessions_init(&service->sessions, service->loop, &session_events, service);
	scenes_init(&service->scenes, &service->children, service->options, service->capacity.scenes, &scenes_events,
		    service);
	jobs_init(&service->jobs, &service->worker, service->options->slice_ms, service->capacity.images);
	if (status == STATUS_OK)
		status = worker_init(&service->worker, &service->children, service->options, &worker_events, service, err);
	if (status == STATUS_OK)
		status = quotes_init(&service->quotes, &service->jobs, &service->worker, service->options->state, err);
	if (status == STATUS_OK)
		status = open_root(service, err);
	if (status == STATUS_OK)
		status = load_own_scenes(service, err);
	if (status == STATUS_OK)
		status = wants_warmth(service->options) ? warm_begin(service, err) : open_door(service, err);
	return status;
}

static void tear_down(struct service *service)
{
	if (!service->loop)
		return;
	quotes_finish(&service->quotes);
	jobs_finish(&service->jobs);
	worker_finish(&service->worker);
	scenes_finish(&service->scenes);
	sessions_finish(&service->sessions);
	children_finish(&service->children);
	close_door(service);
	if (service->signal_fd >= 0)
		close(service->signal_fd);
	if (service->scene_root >= 0)
		close(service->scene_root);
	loop_destroy(service->loop);
}

enum status service_run(const struct options *options, struct error *err)
{
	struct service *service = calloc(1, sizeof *service);
	if (!service)
		return error_set(err, STATUS_MEMORY, "no memory to start");
	service->options = options;
	service->signal_fd = -1;
	service->scene_root = -1;
	service->started_us = clock_us();
	enum status status = set_up(service, err);
	if (status == STATUS_OK) {
		cache_find(&service->cache);
		front_fence_enter(options, &service->fence);
		if (service->listener || options->private_fd >= 0)
			stop_sockets(service);
	}
	if (status == STATUS_OK)
		status = loop_run(service->loop, service_settle, service, &service->stop, err);
	if (status == STATUS_OK && service->own_failure.code != STATUS_OK) {
		*err = service->own_failure;
		status = err->code;
	}
	tear_down(service);
	free(service);
	return status;
}
