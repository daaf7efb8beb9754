#include "tests/fuzz/stage_front.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "protocol/header.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/memfd.h"
#include "server/base/pulse.h"
#include "server/front/child.h"
#include "server/front/fence.h"
#include "server/front/options.h"
#include "server/front/service.h"

#define FIRST_PID (1 << 23) // above those that the kernel gives
#define STEPS_OF_A_JOB 3u
#define TURNS_MOST 200000u // of one input: more, and the front goes round without an end
#define WORK_AT_THE_END 4096u
#define IDS 65536u

struct client {
	int fd; // -1: not connected
	bool reads;
	// What comes back, as a stream of messages.
	uint8_t head[CANDIL_HEADER_BYTES];
	size_t have, body_left;
	unsigned short ends[STAGE_REQUESTS];
};

static struct puppet puppets[STAGE_PUPPETS];
static struct client clients[STAGE_CLIENTS];
static pid_t last_pid;
static uint64_t now_us;
static int next_due_ms; // when the front's next timer is due, as it has told epoll_wait; negative: none
static unsigned turns, work_left;
static bool leaving;
static bool (*act_next)(void *owner);
static void *act_owner;
static struct options options;
static unsigned char steps[IDS];
static char folder[64];

int __real_epoll_wait(int epoll, struct epoll_event *events, int most, int timeout);
int __wrap_epoll_wait(int epoll, struct epoll_event *events, int most, int timeout);

// ---- what the front finds instead of the system ------------------------------------------------------------------------

uint64_t clock_us(void)
{
	return now_us;
}

void log_init(const char *program, enum log_level level)
{
	(void)program, (void)level;
}

void log_line(enum log_level level, const char *format, ...)
{
	// The sentence is made, for its arguments may be what is wrong.
	char line[1024];
	va_list args;
	(void)level;
	va_start(args, format);
	vsnprintf(line, sizeof line, format, args);
	va_end(args);
}

// Nobody works: what is waited for long enough counts as hung.
void pulse_begin(struct pulse *pulse, pid_t pid)
{
	*pulse = (struct pulse){.pid = pid, .looked_us = now_us};
}

uint64_t pulse_look(struct pulse *pulse)
{
	pulse->looked_us = now_us;
	pulse->still++;
	return 0;
}

void children_init(struct children *children, struct loop *loop)
{
	*children = (struct children){.loop = loop};
}

void children_finish(struct children *children)
{
	(void)children;
}

void child_init(struct child *child)
{
	*child = (struct child){.pid = 0, .pidfd = -1, .socket = -1};
}

static struct puppet *puppet_of(pid_t pid)
{
	for (unsigned i = 0; i < STAGE_PUPPETS; i++)
		if (puppets[i].role != STAGE_NOBODY && puppets[i].pid == pid)
			return &puppets[i];
	return NULL;
}

static void make_pair(int type, int pair[2])
{
	if (socketpair(AF_UNIX, type | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair) != 0)
		abort();
}

enum status child_start(struct child *child, enum program program, char *const argv[], int dir, struct error *err)
{
	struct puppet *p = NULL;
	int pair[2];
	(void)dir;
	child_init(child);
	for (unsigned i = 0; i < STAGE_PUPPETS && !p; i++)
		if (puppets[i].role == STAGE_NOBODY)
			p = &puppets[i];
	if (!p)
		return error_set(err, STATUS_INTERNAL, "no process is left");
	make_pair(SOCK_SEQPACKET, pair);
	*p = (struct puppet){.role = STAGE_LOADER, .pid = ++last_pid, .socket = pair[1], .end = eventfd(0, EFD_CLOEXEC)};
	if (program == PROGRAM_WORKER)
		p->role = argv[1] && strcmp(argv[1], "--compile") == 0 ? STAGE_COMPILER : STAGE_WORKER;
	*child = (struct child){.pid = p->pid, .pidfd = fcntl(p->end, F_DUPFD_CLOEXEC, 0), .socket = pair[0]};
	if (p->end < 0 || child->pidfd < 0)
		abort();
	return STATUS_OK;
}

void child_kill(const struct child *child)
{
	if (child->pid > 0)
		stage_end(puppet_of(child->pid), SIGKILL);
}

bool child_is_stopped(const struct child *child)
{
	(void)child;
	return false;
}

// A fence is for good, and the next input needs what it takes.
void front_fence_enter(const struct options *given, struct fence_report *report)
{
	(void)given, (void)report;
}

void front_fence_stop_sockets(struct fence_report *report)
{
	(void)report;
}

static void puppet_go(struct puppet *p)
{
	if (!p->ended)
		close(p->socket);
	close(p->end);
	*p = (struct puppet){.role = STAGE_NOBODY};
}

static void drop_fd(struct loop *loop, int *fd)
{
	if (*fd < 0)
		return;
	loop_forget(loop, *fd);
	close(*fd);
	*fd = -1;
}

static void child_forget(struct child *child, struct loop *loop)
{
	drop_fd(loop, &child->socket);
	drop_fd(loop, &child->pidfd);
	if (child->pid > 0)
		puppet_go(puppet_of(child->pid));
	child_init(child);
}

int child_reap(struct child *child, struct children *children, char *how, size_t capacity)
{
	const struct puppet *p = child->pid > 0 ? puppet_of(child->pid) : NULL;
	const int signal_number = p ? p->signal : 0;
	snprintf(how, capacity, "killed by signal %d", signal_number);
	child_forget(child, children->loop);
	return signal_number;
}

void child_abandon(struct child *child, struct children *children)
{
	if (child->pid > 0)
		child_forget(child, children->loop);
}

// ---- children ----------------------------------------------------------------------------------------------------------

struct puppet *stage_puppet(enum stage_role role)
{
	for (unsigned i = 0; i < STAGE_PUPPETS; i++)
		if (puppets[i].role == role && !puppets[i].ended)
			return &puppets[i];
	return NULL;
}

void stage_end(struct puppet *puppet, int signal_number)
{
	const uint64_t one = 1;
	if (!puppet || puppet->ended)
		return;
	puppet->ended = true;
	puppet->signal = signal_number;
	close(puppet->socket);
	if (write(puppet->end, &one, sizeof one) != sizeof one)
		abort();
}

int stage_sealed(void)
{
	static int fd = -1;
	void *map;
	struct error err;
	if (fd < 0 && (memfd_create_mapped("fuzz", 4096, &fd, &map, &err) != STATUS_OK ||
		       memfd_seal(fd, map, 4096, &err) != STATUS_OK))
		abort();
	return fd;
}

void stage_say(struct puppet *puppet, const void *message, size_t bytes, int fd)
{
	struct error err;
	if (puppet->ended)
		return;
	puppet->said++;
	ipc_send(puppet->socket, message, bytes, fd, &err);
}

static void fill_loaded(struct ipc_loaded *m)
{
	candil_SceneInfo *info = &m->info;
	m->head.op = IPC_LOADED;
	snprintf(m->build, sizeof m->build, "%s", ipc_build());
	snprintf(info->file, sizeof info->file, "scene.gltf");
	snprintf(info->hash, sizeof info->hash, "%032x", 7);
	info->triangles = 12;
	info->materials = 1;
	info->camera_count = 1;
	info->cameras_count = 1;
	snprintf(info->cameras[0].name, sizeof info->cameras[0].name, "camera");
	info->warnings_count = 2;
	snprintf(info->warnings[0], sizeof info->warnings[0], "something was mended");
	info->facts_count = 1;
	snprintf(info->facts[0], sizeof info->facts[0], "emitters");
	info->nodes_count = 1;
	info->animations_count = 1;
	info->animation_count = 1;
	info->material_names_count = 1;
}

static const struct estimate measured = {0.1, 0.05, 0.2, candil_ErrorKind_ERROR_KIND_MEASURED};

static void fill_piloted(struct ipc_piloted *m)
{
	for (unsigned t = 0; t < TECHNIQUE_COUNT; t++)
		m->results[t] = (struct pilot_result){
		    .pixels = 100, .samples = 4, .setup_us = 10, .pixel_us = 10, .sample_us = 1000, .error = measured};
}

// The message of a kind as a worker that works fills it in.
static size_t fill(uint32_t op, uint32_t job, bool final, union stage_message *m)
{
	memset(m, 0, sizeof *m);
	m->head = (struct ipc_head){.op = op, .job = job};
	switch (op) {
	case IPC_READY:
		snprintf(m->ready.build, sizeof m->ready.build, "%s", ipc_build());
		snprintf(m->ready.device, sizeof m->ready.device, "fake");
		snprintf(m->ready.key, sizeof m->ready.key, "0");
		m->ready.others = 1;
		return sizeof m->ready;
	case IPC_BEGUN:
		steps[job % IDS] = 0;
		m->begun.accepted.technique = candil_Technique_TECHNIQUE_PT;
		m->begun.accepted.samples = STEPS_OF_A_JOB;
		m->begun.accepted.plan_count = 1;
		m->begun.accepted.notes_count = 1;
		return sizeof m->begun;
	case IPC_STEPPED:
		m->stepped.samples_done = ++steps[job % IDS];
		m->stepped.ready = 1;
		m->stepped.finished = steps[job % IDS] >= STEPS_OF_A_JOB;
		m->stepped.fraction = 1;
		m->stepped.estimate = measured;
		m->stepped.device_us = 1000;
		return sizeof m->stepped;
	case IPC_IMAGE:
		m->image.frame.final = final;
		m->image.frame.width = m->image.frame.height = 64;
		m->image.frame.bytes = 4096;
		m->image.done.samples = STEPS_OF_A_JOB;
		m->image.done.stages_count = 1;
		m->image.done.figures_count = 1;
		return sizeof m->image;
	case IPC_PILOTED:
		fill_piloted(&m->piloted);
		return sizeof m->piloted;
	case IPC_LOST:
		error_set(&m->lost.error, STATUS_DEVICE, "the device was lost");
		return sizeof m->lost;
	case IPC_STATE:
		m->state.device_bytes = 1000;
		return sizeof m->state;
	case IPC_LOADED:
		fill_loaded(&m->loaded);
		return sizeof m->loaded;
	}
	return 0;
}

// The op that answers the next order, and its job; 0: there is none that wants an answer.
static uint32_t take_order(struct puppet *p, uint32_t *job, bool *final)
{
	static union {
		struct ipc_head head;
		struct ipc_read read;
		uint8_t bytes[IPC_MAX_BYTES];
	} order;
	static const uint32_t answers[][2] = {
	    {IPC_BEGIN, IPC_BEGUN}, {IPC_STEP, IPC_STEPPED}, {IPC_READ, IPC_IMAGE}, {IPC_PILOT, IPC_PILOTED}};
	size_t bytes;
	int fd;
	while (ipc_receive(p->socket, &order, sizeof order, &bytes, &fd, NULL) == STATUS_OK && bytes > 0) {
		if (fd >= 0)
			close(fd);
		for (size_t i = 0; i < sizeof answers / sizeof *answers; i++)
			if (order.head.op == answers[i][0]) {
				*job = order.head.job;
				*final = order.head.op == IPC_READ && order.read.final;
				return answers[i][1];
			}
	}
	return 0;
}

size_t stage_answer(struct puppet *puppet, uint32_t op, union stage_message *m)
{
	uint32_t job = 0;
	bool final = false;
	uint32_t due = 0;
	if (puppet->role == STAGE_LOADER)
		due = puppet->said == 0 ? IPC_LOADED : 0;
	else if (puppet->role == STAGE_WORKER)
		due = puppet->said == 0 ? IPC_READY : take_order(puppet, &job, &final);
	return op || due ? fill(op ? op : due, job, final, m) : 0;
}

bool stage_work(struct puppet *puppet)
{
	static union stage_message m;
	if (!puppet || puppet->ended)
		return false;
	if (puppet->role == STAGE_COMPILER) {
		stage_end(puppet, 0);
		return true;
	}
	const size_t bytes = stage_answer(puppet, 0, &m);
	if (bytes > 0)
		stage_say(puppet, &m, bytes, m.head.op == IPC_IMAGE || m.head.op == IPC_LOADED ? stage_sealed() : -1);
	return bytes > 0;
}

// ---- clients -----------------------------------------------------------------------------------------------------------

static bool client_connect(struct client *c)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	memcpy(address.sun_path, options.socket, strlen(options.socket) + 1);
	c->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (c->fd >= 0 && connect(c->fd, (struct sockaddr *)&address, sizeof address) == 0)
		return true;
	close(c->fd);
	c->fd = -1;
	return false;
}

void stage_send(unsigned client, const void *bytes, size_t size, bool with_folder)
{
	struct client *c = &clients[client % STAGE_CLIENTS];
	struct error err;
	const int dir = with_folder ? open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC) : -1;
	if (size > 0 && (c->fd >= 0 || client_connect(c)))
		ipc_send(c->fd, bytes, size, dir, &err);
	if (dir >= 0)
		close(dir);
}

void stage_hang_up(unsigned client)
{
	struct client *c = &clients[client % STAGE_CLIENTS];
	if (c->fd >= 0)
		close(c->fd);
	c->fd = -1;
	c->reads = true;
	c->have = 0;
	c->body_left = 0;
}

unsigned stage_ends(unsigned client, uint32_t request)
{
	return clients[client % STAGE_CLIENTS].ends[request % STAGE_REQUESTS];
}

void stage_reads(unsigned client, bool reads)
{
	clients[client % STAGE_CLIENTS].reads = reads;
}

static bool is_an_end(uint8_t type)
{
	bool is = type == MESSAGE_ERROR;
#define X(name, number, reply) is |= type == MESSAGE_##reply;
	CANDIL_REQUEST_LIST(X)
#undef X
	return is;
}

static size_t take(struct client *c, const uint8_t *bytes, size_t size)
{
	if (c->body_left > 0) {
		const size_t n = size < c->body_left ? size : c->body_left;
		c->body_left -= n;
		return n;
	}
	c->head[c->have++] = bytes[0];
	if (c->have == sizeof c->head) {
		struct header header;
		// Whatever comes in, a client gets a stream of replies.
		if (header_decode(c->head, &header) != STATUS_OK || !message_is_reply(header.type))
			abort();
		c->have = 0;
		c->body_left = header.length;
		c->ends[header.request % STAGE_REQUESTS] += is_an_end(header.type);
	}
	return 1;
}

static bool client_read(struct client *c)
{
	static uint8_t bytes[65536];
	const ssize_t got = c->fd >= 0 && c->reads ? recv(c->fd, bytes, sizeof bytes, 0) : -1;
	for (ssize_t i = 0; i < got;)
		i += (ssize_t)take(c, bytes + i, (size_t)(got - i));
	if (got == 0)
		stage_hang_up((unsigned)(c - clients));
	return got > 0;
}

static bool clients_read(void)
{
	bool any = false;
	for (unsigned i = 0; i < STAGE_CLIENTS; i++)
		any |= client_read(&clients[i]);
	return any;
}

// ---- the play ----------------------------------------------------------------------------------------------------------

void stage_pass(void)
{
	if (next_due_ms > 0)
		now_us += (uint64_t)next_due_ms * 1000;
}

// Something that may end of itself does so: orders are carried out, then time passes.
static void come_to_an_end(void)
{
	bool worked = false;
	for (enum stage_role role = STAGE_LOADER; role <= STAGE_COMPILER; role++)
		worked |= work_left > 0 && stage_work(stage_puppet(role));
	if (worked) {
		work_left--;
		return;
	}
	// The first signal asks the front to leave, which takes it a while; a second one is for when it does not.
	if (!leaving || next_due_ms < 0)
		raise(SIGTERM);
	leaving = true;
	stage_pass();
}

int __wrap_epoll_wait(int epoll, struct epoll_event *events, int most, int timeout)
{
	const int count = __real_epoll_wait(epoll, events, most, 0);
	if (++turns > TURNS_MOST)
		abort();
	if (count != 0 || timeout == 0 || clients_read())
		return count;
	next_due_ms = timeout;
	if (leaving || !act_next(act_owner))
		come_to_an_end();
	return 0;
}

static void remove_folder(void)
{
	char path[128];
	snprintf(path, sizeof path, "%s/box.gltf", folder);
	unlink(path);
	rmdir(folder);
}

static void prepare(void)
{
	char path[128];
	const char *tmp = getenv("TMPDIR");
	snprintf(folder, sizeof folder, "%.30s/candil-fuzz-XXXXXX", tmp ? tmp : "/tmp");
	if (!mkdtemp(folder))
		abort();
	snprintf(path, sizeof path, "%s/box.gltf", folder);
	const int file = open(path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
	if (file < 0)
		abort();
	close(file);
	atexit(remove_folder);
	options = (struct options){.private_fd = -1, .slice_ms = 50, .answer_s = LIMIT_ANSWER_SECONDS, .scene_root = folder};
	snprintf(options.socket, sizeof options.socket, "%s/socket", folder);
}

void stage_run(bool (*act)(void *owner), void *owner)
{
	struct error err;
	if (!folder[0])
		prepare();
	for (unsigned i = 0; i < STAGE_CLIENTS; i++)
		clients[i] = (struct client){.fd = -1, .reads = true};
	now_us = 1000000;
	last_pid = FIRST_PID;
	turns = 0;
	work_left = WORK_AT_THE_END;
	leaving = false;
	act_next = act;
	act_owner = owner;
	memset(steps, 0, sizeof steps);
	if (service_run(&options, &err) != STATUS_OK)
		abort();
	while (clients_read())
		continue;
	for (unsigned i = 0; i < STAGE_CLIENTS; i++)
		stage_hang_up(i);
	for (unsigned i = 0; i < STAGE_PUPPETS; i++)
		if (puppets[i].role != STAGE_NOBODY)
			abort(); // a child that nobody ended
}
