// Design note. The worker's death shows in two places: its socket hangs up, and its pidfd becomes readable. Only the pidfd
// counts: when it is readable, the worker's last messages are read and then its loss is handled. A hang-up alone gets the
// worker killed. So each answer that was sent is heard, and each loss is handled once.
#include "server/front/worker.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <unistd.h>

#include "protocol/text.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/memfd.h"
#include "server/front/answers.h"

#define FIRST_PAUSE_US 50000u
#define PAUSE_DOUBLINGS 8u
#define HOPELESS_STARTS 3u
#define MESSAGES_PER_TURN 64u

static void worker_start(void *owner);
static void watch_over(struct worker *worker);

// ---- orders ----------------------------------------------------------------------------------------------------------

static void kill_for(struct worker *worker, const char *why)
{
	if (!worker->killed_for)
		worker->killed_for = why;
	child_kill(&worker->child);
}

static void kill_hanging(struct worker *worker, const char *why)
{
	worker->fault = child_is_stopped(&worker->child) ? FAULT_NONE : FAULT_WORK;
	kill_for(worker, why);
}

static void send_parcels(struct worker *worker);

static void send_again(void *owner)
{
	struct worker *worker = owner;
	if (worker->state == WORKER_READY)
		send_parcels(worker);
}

// Be told when it takes more: by its socket, or, while too many descriptors of the user are on their way, by the clock.
static void want_to_send(struct worker *worker)
{
	loop_want(worker->loop, worker->child.socket, worker->crowded ? EPOLLIN : EPOLLIN | EPOLLOUT);
	if (worker->crowded && !worker->again.running)
		loop_timer_set(worker->loop, &worker->again, clock_us() + IPC_PAUSE_MS * 1000, send_again, worker);
}

static void worker_keep(struct worker *worker, const void *message, size_t bytes, int fd)
{
	const char *why = parcels_keep(&worker->waiting, message, bytes, fd);
	if (why)
		kill_for(worker, why);
	else if (!worker->holding)
		want_to_send(worker);
}

enum sent { SENT, SENT_LATER };

// A message to a worker that has just died counts as sent: the loop will tell of its death. If a message is lost for any
// other reason, want of memory for instance, the worker knows less than the front believes, and is killed.
static enum sent send_now(struct worker *worker, const void *message, size_t bytes, int fd)
{
	if (ipc_send(worker->child.socket, message, bytes, fd, NULL) == STATUS_OK || errno == EPIPE || errno == ECONNRESET)
		return SENT;
	worker->crowded = errno == ETOOMANYREFS;
	if (errno == EAGAIN || worker->crowded)
		return SENT_LATER;
	kill_for(worker, "a message could not be sent to it");
	return SENT;
}

static void worker_give(struct worker *worker, const void *message, size_t bytes, int fd)
{
	if (worker->state != WORKER_READY)
		return;
	if (worker->waiting.first || worker->holding || send_now(worker, message, bytes, fd) == SENT_LATER)
		worker_keep(worker, message, bytes, fd);
}

static void send_parcels(struct worker *worker)
{
	worker->crowded = false;
	while (worker->waiting.first && !worker->holding) {
		const struct parcel *p = worker->waiting.first;
		if (send_now(worker, p->message, p->bytes, p->fd) == SENT_LATER) {
			want_to_send(worker); // what was kept while a pilot was out has not asked for it
			return;
		}
		parcels_drop_first(&worker->waiting);
	}
	loop_want(worker->loop, worker->child.socket, EPOLLIN);
}

static void expect_answer(struct worker *worker)
{
	if (worker->answers_due++ == 0)
		worker->answer_work_us = 0;
	watch_over(worker);
}

void worker_scene(struct worker *worker, uint64_t scene, int blob)
{
	struct ipc_scene message = {.head = {.op = IPC_SCENE}, .scene = scene};
	worker_give(worker, &message, sizeof message, blob);
}

void worker_forget(struct worker *worker, uint64_t scene)
{
	struct ipc_scene message = {.head = {.op = IPC_FORGET}, .scene = scene};
	// A scene that the worker has not been given yet is taken out of the queue: while the worker is busy, scenes that
	// come and go must neither fill the queue nor keep their memory. Orders behind it in the queue that are about the
	// scene can only be of jobs that have ended since.
	if (!parcels_take_back(&worker->waiting, scene))
		worker_give(worker, &message, sizeof message, -1);
}

void worker_begin(struct worker *worker, uint32_t job, const struct subject *subject, const candil_Render *render,
		  uint64_t end_us, bool compile)
{
	struct ipc_begin message = {
	    .head = {.op = IPC_BEGIN, .job = job}, .render = *render, .end_us = end_us, .compile = compile};
	subject_ids(subject, message.parts);
	worker_give(worker, &message, sizeof message, -1);
	expect_answer(worker);
}

void worker_step(struct worker *worker, uint32_t job, uint32_t budget_us)
{
	struct ipc_step message = {.head = {.op = IPC_STEP, .job = job}, .budget_us = budget_us};
	worker_give(worker, &message, sizeof message, -1);
	expect_answer(worker);
}

void worker_read(struct worker *worker, uint32_t job, bool final, const struct estimate *predicted)
{
	struct ipc_read message = {.head = {.op = IPC_READ, .job = job}, .final = final, .predicted = *predicted};
	worker_give(worker, &message, sizeof message, -1);
	if (worker->images_due++ == 0)
		worker->image_work_us = 0;
	watch_over(worker);
}

void worker_end(struct worker *worker, uint32_t job)
{
	struct ipc_job message = {.head = {.op = IPC_END, .job = job}};
	worker_give(worker, &message, sizeof message, -1);
}

void worker_pilot(struct worker *worker, const struct ipc_pilot *pilot)
{
	struct ipc_pilot message = *pilot;
	message.head.op = IPC_PILOT;
	worker_give(worker, &message, sizeof message, -1);
	expect_answer(worker);
	worker->pilot = message.head.job;
	worker->holding = !worker->waiting.first;
}

bool worker_pilot_end(struct worker *worker)
{
	const struct ipc_job message = {.head = {.op = IPC_PILOT_END, .job = worker->pilot}};
	// While the worker has not come to its PILOT yet, this would wait in line with the rest.
	return worker->state == WORKER_READY && worker->holding && send_now(worker, &message, sizeof message, -1) == SENT;
}

// ---- the watchdog ----------------------------------------------------------------------------------------------------

// Seconds that it may be still. Of a software device the worker does all work itself. While a GPU works the worker sleeps;
// most drivers give up on a GPU that hangs within seconds, and the device is then lost. Where none does, this bound is left.
unsigned worker_patience_s(const struct worker *worker)
{
	const struct options *o = worker->options;
	return o->hang_s > 0 ? o->hang_s : worker->ready.software ? LIMIT_HANG_SECONDS : LIMIT_HANG_GPU_SECONDS;
}

static bool worker_looked(void *owner, bool hangs, uint64_t work_us)
{
	struct worker *worker = owner;
	const uint64_t most_us = worker->options->answer_s * 1000000ull;
	worker->answer_work_us += work_us;
	worker->image_work_us += work_us;
	if (worker->crowded) {
		watch_forgive(&worker->watch); // it may be still, for it has not been given what it is to work on
		hangs = false;
	}
	if (hangs)
		kill_hanging(worker, "it hung: with an order to carry out it neither worked nor waited for a processor");
	else if (worker->answers_due > 0 && worker->answer_work_us > most_us)
		kill_hanging(worker, "it hung: it worked on one order without an end");
	// An image may have to wait for an order before it is encoded.
	else if (worker->images_due > 0 && worker->image_work_us > 2 * most_us)
		kill_hanging(worker, "it hung: it worked on one image without an end");
	else
		return true;
	return false;
}

static void watch_over(struct worker *worker)
{
	if (worker->answers_due == 0 && worker->images_due == 0) {
		watch_end(&worker->watch);
	} else if (!worker->watch.timer.running) {
		worker->quiet_us = clock_us();
		watch_begin(&worker->watch, worker->loop, worker->child.pid, worker_patience_s(worker), worker_looked,
			    worker);
	}
}

static void worker_answered(struct worker *worker, unsigned *due, uint64_t *work_us)
{
	if (*due > 0)
		(*due)--;
	*work_us = 0;
	watch_forgive(&worker->watch);
	worker->quiet_us = clock_us();
	watch_over(worker);
}

uint64_t worker_quiet_us(const struct worker *worker)
{
	return worker->answers_due > 0 || worker->images_due > 0 ? worker->quiet_us : UINT64_MAX;
}

// ---- answers ---------------------------------------------------------------------------------------------------------

static void got_ready(struct worker *worker, struct ipc_ready *ready)
{
	if (strncmp(ready->build, ipc_build(), sizeof ready->build) != 0) {
		kill_for(worker, "it is of another build than candild: install both anew");
		return;
	}
	worker_answered(worker, &worker->answers_due, &worker->answer_work_us);
	answer_ready_clean(ready);
	worker->ready = *ready;
	worker->state = WORKER_READY;
	worker->failed_starts = 0;
	if (ready->error.code == STATUS_OK)
		log_line(LOG_INFO, "worker %d: ready on %s", (int)worker->child.pid, ready->device);
	else
		log_line(LOG_ERROR, "worker %d: no usable device: %s", (int)worker->child.pid, ready->error.text);
	worker->events->ready(worker->owner);
}

static void got_stepped(struct worker *worker, struct ipc_stepped *stepped)
{
	worker_answered(worker, &worker->answers_due, &worker->answer_work_us);
	worker->failures = 0;
	answer_stepped_clean(stepped);
	worker->events->stepped(worker->owner, stepped->head.job, stepped);
}

static void got_begun(struct worker *worker, struct ipc_begun *begun)
{
	if (!answer_begun_holds(begun)) {
		kill_for(worker, "it sent nonsense");
		return;
	}
	worker_answered(worker, &worker->answers_due, &worker->answer_work_us);
	worker->events->begun(worker->owner, begun->head.job, begun);
}

static void got_piloted(struct worker *worker, struct ipc_piloted *piloted)
{
	if (piloted->head.job != worker->pilot || worker->pilot == 0 || !answer_piloted_holds(piloted)) {
		kill_for(worker, "it sent nonsense");
		return;
	}
	worker->pilot = 0;
	worker->holding = false;
	send_parcels(worker);
	worker_answered(worker, &worker->answers_due, &worker->answer_work_us);
	worker->events->piloted(worker->owner, piloted->head.job, piloted);
}

static void got_image(struct worker *worker, struct ipc_image *image, int fd)
{
	const void *map;
	size_t size = 0;
	if (!answer_image_holds(image)) {
		kill_for(worker, "it sent nonsense");
		if (fd >= 0)
			close(fd);
		return;
	}
	worker_answered(worker, &worker->images_due, &worker->image_work_us);
	if (fd == IPC_LOST_FD)
		error_set(&image->error, STATUS_MEMORY,
			  "no descriptor was left for the image: ask again when less is under way");
	if (image->error.code == STATUS_OK && memfd_map_sealed(fd, &map, &size, &image->error) == STATUS_OK) {
		munmap((void *)(uintptr_t)map, size);
		image->frame.bytes = size;
	}
	if (image->error.code != STATUS_OK && fd >= 0) {
		close(fd);
		fd = -1;
	}
	worker->events->image(worker->owner, image->head.job, image, fd);
}

static bool is_message(const struct ipc_head *head, size_t bytes, enum ipc_op op, size_t size)
{
	return bytes == size && head->op == (uint32_t)op;
}

static void worker_handle(struct worker *worker, size_t bytes, int fd)
{
	void *message = worker->inbox;
	const struct ipc_head *head = message;
	if (worker->state == WORKER_STARTING) {
		if (is_message(head, bytes, IPC_READY, sizeof(struct ipc_ready)))
			got_ready(worker, message);
		else
			kill_for(worker, "it did not say that it was ready: install candil anew");
	} else if (is_message(head, bytes, IPC_BEGUN, sizeof(struct ipc_begun))) {
		got_begun(worker, message);
	} else if (is_message(head, bytes, IPC_STEPPED, sizeof(struct ipc_stepped))) {
		got_stepped(worker, message);
	} else if (is_message(head, bytes, IPC_PILOTED, sizeof(struct ipc_piloted))) {
		got_piloted(worker, message);
	} else if (is_message(head, bytes, IPC_IMAGE, sizeof(struct ipc_image))) {
		got_image(worker, message, fd);
		return;
	} else if (is_message(head, bytes, IPC_LOST, sizeof(struct ipc_lost))) {
		worker->device_lost = ((const struct ipc_lost *)message)->error;
		text_clean(worker->device_lost.text, sizeof worker->device_lost.text);
	} else if (is_message(head, bytes, IPC_WAITS, sizeof *head)) {
		watch_forgive(&worker->watch);
	} else if (is_message(head, bytes, IPC_STATE, sizeof(struct ipc_state))) {
		worker->held = *(const struct ipc_state *)message;
	} else {
		kill_for(worker, "it sent nonsense");
	}
	if (fd >= 0)
		close(fd);
}

enum heard { HEARD_ALL, HEARD_SOME, HEARD_END };

// Read and handle the messages that are there, at most so many.
static enum heard listen_to(struct worker *worker, unsigned messages)
{
	for (unsigned i = 0; i < messages; i++) {
		size_t bytes;
		int fd;
		struct error err;
		if (ipc_receive(worker->child.socket, worker->inbox, IPC_MAX_BYTES, &bytes, &fd, &err) != STATUS_OK) {
			if (err.code == STATUS_IO && errno == EAGAIN)
				return HEARD_ALL;
			kill_for(worker, "its messages cannot be read");
			return HEARD_END;
		}
		if (bytes == 0)
			return HEARD_END;
		worker_handle(worker, bytes, fd);
	}
	return HEARD_SOME;
}

static void worker_spoke(void *owner, uint32_t events)
{
	struct worker *worker = owner;
	if (events & EPOLLOUT)
		send_parcels(worker);
	if (listen_to(worker, MESSAGES_PER_TURN) == HEARD_END) {
		loop_forget(worker->loop, worker->child.socket);
		child_kill(&worker->child);
	}
}

// ---- life ------------------------------------------------------------------------------------------------------------

static void worker_lose(struct worker *worker, const char *how, enum worker_fault fault)
{
	bool was_starting = worker->state != WORKER_READY;
	unsigned doublings = worker->failures < PAUSE_DOUBLINGS ? worker->failures : PAUSE_DOUBLINGS;
	worker->failures++;
	worker->failed_starts = was_starting ? worker->failed_starts + 1 : 0;
	worker->state = WORKER_DOWN;
	worker->answers_due = 0;
	worker->images_due = 0;
	worker->pilot = 0;
	worker->holding = false;
	worker->held = (struct ipc_state){0};
	worker->crowded = false;
	worker->killed_for = NULL;
	worker->fault = FAULT_NONE;
	worker->device_lost = (struct error){.code = STATUS_OK};
	watch_over(worker);
	parcels_clear(&worker->waiting);
	log_line(LOG_ERROR, "worker lost (%s); the next one starts in %u ms", how, (FIRST_PAUSE_US << doublings) / 1000);
	loop_timer_set(worker->loop, &worker->restart, clock_us() + (FIRST_PAUSE_US << doublings), worker_start, worker);
	const struct worker_loss loss = {.how = how, .fault = fault, .hopeless = worker->failed_starts >= HOPELESS_STARTS};
	worker->events->lost(worker->owner, &loss);
}

// Signals by which a process ends for what it did itself. SIGKILL is sent by others: by people, or by the kernel for want of
// memory, and then what is killed need not be what took it.
bool worker_is_own_fault(int signal_number)
{
	static const int own[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGSYS, SIGTRAP};
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		if (signal_number == own[i])
			return true;
	return false;
}

static void worker_ended(void *owner, uint32_t events)
{
	struct worker *worker = owner;
	char how[64];
	struct error why;
	(void)events;
	// What it said before it ended, all of it: no more can come.
	while (listen_to(worker, MESSAGES_PER_TURN) == HEARD_SOME)
		continue;
	const bool lost = worker->device_lost.code != STATUS_OK;
	const char *killed_for = lost ? worker->device_lost.text : worker->killed_for;
	enum worker_fault fault = lost ? FAULT_DEVICE : worker->fault;
	const int signal_number = child_reap(&worker->child, worker->children, how, sizeof how);
	if (!killed_for && (worker_is_own_fault(signal_number) || (signal_number == 0 && worker->state == WORKER_READY)))
		fault = FAULT_WORK;
	error_set(&why, STATUS_WORKER_LOST, "%s", killed_for ? killed_for : how);
	worker_lose(worker, why.text, fault);
}

bool worker_blame_device(struct worker *worker)
{
	if (!worker->ready.key[0] || !device_losses_add(&worker->losses, &worker->ready, clock_us()))
		return false;
	log_line(LOG_ERROR, "%s was lost %u times: %s", worker->ready.device, LIMIT_DEVICE_LOSSES,
		 worker->losses.stays ? "there is no other that may be used" : "the next device is taken");
	return true;
}

void worker_device_note(const struct worker *worker, char note[LIMIT_TEXT + 1])
{
	device_losses_note(&worker->losses, worker->ready.device, clock_us(), note);
}

enum status worker_command(struct worker *worker, bool compile, struct worker_command *c, struct error *err)
{
	static char compile_option[] = "--compile", device_option[] = "--device", gpu_option[] = "--require-gpu",
		    budget_option[] = "--memory-budget", avoid_option[] = "--avoid";
	const struct options *o = worker->options;
	unsigned count = 0;
	int length = snprintf(c->program, sizeof c->program, "%s/candil-worker", o->libexec);
	if (length < 0 || (size_t)length >= sizeof c->program)
		return error_set(err, STATUS_INTERNAL, "the path of candil-worker is too long");
	c->argv[count++] = c->program;
	if (compile) {
		snprintf(c->taken, sizeof c->taken, "%llu", (unsigned long long)(worker->held.device_bytes >> 20));
		c->argv[count++] = compile_option;
		c->argv[count++] = c->taken;
	}
	if (o->device) {
		snprintf(c->device, sizeof c->device, "%s", o->device);
		c->argv[count++] = device_option;
		c->argv[count++] = c->device;
	}
	if (o->require_gpu)
		c->argv[count++] = gpu_option;
	if (o->memory_budget_mib > 0) {
		snprintf(c->budget, sizeof c->budget, "%u", o->memory_budget_mib);
		c->argv[count++] = budget_option;
		c->argv[count++] = c->budget;
	}
	for (unsigned i = 0; i < worker->losses.avoided_count; i++) {
		c->argv[count++] = avoid_option;
		c->argv[count++] = worker->losses.avoided[i];
	}
	c->argv[count] = NULL;
	return STATUS_OK;
}

static enum status worker_launch(struct worker *worker, struct error *err)
{
	struct worker_command command;
	enum status status = worker_command(worker, false, &command, err);
	if (status == STATUS_OK)
		status = child_start(&worker->child, PROGRAM_WORKER, command.argv, -1, err);
	if (status == STATUS_OK)
		status = loop_watch(worker->loop, worker->child.socket, EPOLLIN, worker_spoke, worker, err);
	if (status == STATUS_OK)
		status = loop_watch(worker->loop, worker->child.pidfd, EPOLLIN, worker_ended, worker, err);
	if (status != STATUS_OK)
		child_abandon(&worker->child, worker->children);
	return status;
}

static void worker_start(void *owner)
{
	struct worker *worker = owner;
	struct error err;
	worker->state = WORKER_STARTING;
	if (worker_launch(worker, &err) != STATUS_OK) {
		worker_lose(worker, err.text, FAULT_NONE);
		return;
	}
	worker->starts++;
	log_line(LOG_INFO, "worker %d: started", (int)worker->child.pid);
	expect_answer(worker); // READY, for which the watchdog waits as for any answer
}

enum status worker_init(struct worker *worker, struct children *children, const struct options *options,
			const struct worker_events *events, void *owner, struct error *err)
{
	*worker = (struct worker){
	    .loop = children->loop, .children = children, .options = options, .events = events, .owner = owner};
	child_init(&worker->child);
	worker->inbox = malloc(IPC_MAX_BYTES);
	if (!worker->inbox)
		return error_set(err, STATUS_MEMORY, "no memory for the worker's messages");
	// The loop starts it: the owner, who is told of a failure, is not yet complete.
	loop_timer_set(worker->loop, &worker->restart, 0, worker_start, worker);
	return STATUS_OK;
}

void worker_finish(struct worker *worker)
{
	if (!worker->inbox)
		return;
	loop_timer_stop(worker->loop, &worker->restart);
	loop_timer_stop(worker->loop, &worker->again);
	watch_end(&worker->watch);
	child_abandon(&worker->child, worker->children);
	parcels_clear(&worker->waiting);
	free(worker->inbox);
	worker->inbox = NULL;
	worker->state = WORKER_DOWN;
}
