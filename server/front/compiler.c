#include "server/front/compiler.h"

#include <sys/epoll.h>

#include "protocol/names.h"
#include "server/base/clock.h"
#include "server/base/ipc.h"
#include "server/base/log.h"
#include "server/base/side.h"

static bool works_without_end(const struct compiler *c)
{
	return c->work_us > c->worker->options->answer_s * 1000000ull;
}

static bool compiler_looked(void *owner, bool hangs, uint64_t work_us)
{
	struct compiler *c = owner;
	c->work_us += work_us;
	if (!hangs && !works_without_end(c))
		return true;
	child_kill(&c->child);
	return false;
}

static void compiler_ended(void *owner, uint32_t events)
{
	struct compiler *c = owner;
	char how[64];
	const uint64_t code = c->code;
	(void)events;
	const int signal_number = child_reap(&c->child, c->worker->children, how, sizeof how);
	const char *failure = worker_is_own_fault(signal_number) ? how : works_without_end(c) ? "without an end" : NULL;
	watch_end(&c->watch);
	log_line(LOG_INFO, "compiler of %016llx: %s", (unsigned long long)code, how);
	c->code = 0;
	c->done(c->owner, code, failure);
}

// It says nothing, so this is its end, which its pidfd tells, too.
static void compiler_hung_up(void *owner, uint32_t events)
{
	struct compiler *c = owner;
	(void)events;
	loop_forget(c->worker->loop, c->child.socket);
}

void compiler_init(struct compiler *c, struct worker *worker, compiler_done *done, void *owner)
{
	*c = (struct compiler){.worker = worker, .done = done, .owner = owner};
	child_init(&c->child);
}

#define LEAST_SIDE 12u // pixels

// A picture of this size is nobody's, and would take the device's memory. Some options of techniques without noise are about
// sides: pictures with these stay as they are.
static void make_small(candil_Render *render)
{
	if (render->options_count > 0 && !(technique_traits(render->technique) & TECHNIQUE_NOISE))
		return;
	render->width = side_near(LEAST_SIDE, render->width);
	render->height = side_near(LEAST_SIDE, render->height);
}

// All of it fits a socket's buffer, so nothing waits for the process to start.
static enum status give_orders(const struct compiler *c, const struct subject *subject, const candil_Render *render,
			       uint32_t pilot_us, struct error *err)
{
	enum status status = STATUS_OK;
	for (unsigned i = 0; status == STATUS_OK && i < PARTS; i++) {
		const struct scene *scene = subject->part[i];
		if (!scene)
			continue;
		const struct ipc_scene message = {.head = {.op = IPC_SCENE}, .scene = scene->id};
		status = ipc_send(c->child.socket, &message, sizeof message, scene->blob, err);
	}
	struct ipc_begin begin = {
	    .head = {.op = IPC_BEGIN, .job = 1}, .render = *render, .end_us = UINT64_MAX, .compile = true};
	struct ipc_pilot pilot = {.head = {.op = IPC_PILOT, .job = 1},
				  .render = *render,
				  .techniques = 1u << render->technique,
				  .budget_us = pilot_us,
				  .limit_us = UINT32_MAX,
				  .compile = true};
	make_small(&begin.render);
	subject_ids(subject, begin.parts);
	subject_ids(subject, pilot.parts);
	if (status != STATUS_OK)
		return status;
	return pilot_us > 0 ? ipc_send(c->child.socket, &pilot, sizeof pilot, -1, err)
			    : ipc_send(c->child.socket, &begin, sizeof begin, -1, err);
}

enum status compiler_start(struct compiler *c, uint64_t code, const struct subject *subject, const candil_Render *render,
			   uint32_t pilot_us, struct error *err)
{
	struct worker_command command;
	enum status status = worker_command(c->worker, true, &command, err);
	if (status == STATUS_OK)
		status = child_start(&c->child, PROGRAM_WORKER, command.argv, -1, err);
	if (status == STATUS_OK)
		status = loop_watch(c->worker->loop, c->child.socket, EPOLLIN, compiler_hung_up, c, err);
	if (status == STATUS_OK)
		status = loop_watch(c->worker->loop, c->child.pidfd, EPOLLIN, compiler_ended, c, err);
	if (status == STATUS_OK)
		status = give_orders(c, subject, render, pilot_us, err);
	if (status != STATUS_OK) {
		compiler_stop(c);
		return status;
	}
	c->code = code;
	c->work_us = 0;
	watch_begin(&c->watch, c->worker->loop, c->child.pid, worker_patience_s(c->worker), compiler_looked, c);
	return STATUS_OK;
}

void compiler_stop(struct compiler *c)
{
	watch_end(&c->watch);
	child_abandon(&c->child, c->worker->children);
	c->code = 0;
}
