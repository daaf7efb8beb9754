// Children that their parent cannot collect at once: one that is traced is hidden from it after its end, until its tracer
// has been told or is gone (ptrace(2), waitid(2)). This program is the child, too.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdbool.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/ipc.h"
#include "server/front/child.h"

#define LOOKS_US 350000 // long enough for several looks at a child that is hidden
#define GIVE_UP_US 60000000

struct stage {
	struct loop *loop;
	struct children children;
	struct child child;
	pid_t tracer, pid;
	int go; // closed: the tracer ends
	struct loop_timer timer;
	unsigned settled; // turns of the loop
	bool until_none, stop;
};

// The child: let anyone trace it, say so, and wait for its end.
static int be_child(void)
{
	prctl(PR_SET_PTRACER, PR_SET_PTRACER_ANY, 0, 0, 0);
	if (write(IPC_FD, "x", 1) != 1)
		return 1;
	for (;;)
		pause();
}

// Trace `pid` without ever asking for its end.
static _Noreturn void be_tracer(pid_t pid, int said, int go)
{
	char byte;
	const bool traces = ptrace(PTRACE_SEIZE, pid, NULL, NULL) == 0;
	if (write(said, traces ? "y" : "n", 1) == 1 && read(go, &byte, 1) == 0)
		_exit(0);
	_exit(1);
}

static void begin(struct stage *t)
{
	static char self[] = "/proc/self/exe", child[] = "child";
	char *argv[] = {self, child, NULL};
	int said[2], go[2];
	char byte = 0;
	struct error err;
	*t = (struct stage){.stop = false};
	assert_int_equal(loop_create(&t->loop, &err), STATUS_OK);
	children_init(&t->children, t->loop);
	assert_int_equal(child_start(&t->child, PROGRAM_LOADER, argv, -1, &err), STATUS_OK);
	t->pid = t->child.pid;
	struct pollfd ready = {.fd = t->child.socket, .events = POLLIN};
	assert_int_equal(poll(&ready, 1, -1), 1);
	assert_int_equal(pipe(said), 0);
	assert_int_equal(pipe(go), 0);
	t->tracer = fork();
	if (t->tracer == 0) {
		close(go[1]);
		be_tracer(t->pid, said[1], go[0]);
	}
	close(said[1]);
	close(go[0]);
	t->go = go[1];
	assert_int_equal(read(said[0], &byte, 1), 1);
	close(said[0]);
	if (byte == 'y')
		return;
	print_message("nobody may trace here\n");
	child_kill(&t->child);
	_exit(77);
}

static void end_tracer(struct stage *t)
{
	close(t->go);
	assert_int_equal(waitpid(t->tracer, NULL, 0), t->tracer);
}

static void end(struct stage *t)
{
	assert_int_equal(waitpid(t->pid, NULL, WNOHANG), -1);
	assert_int_equal(errno, ECHILD);
	loop_destroy(t->loop);
}

static void settle(void *owner)
{
	struct stage *t = owner;
	t->settled++;
	t->stop |= t->until_none && t->children.count == 0;
}

static void time_is_over(void *owner)
{
	struct stage *t = owner;
	t->stop = true;
}

static void run(struct stage *t, bool until_none, uint64_t us)
{
	struct error err;
	t->stop = false;
	t->until_none = until_none;
	loop_timer_set(t->loop, &t->timer, clock_us() + us, time_is_over, t);
	assert_int_equal(loop_run(t->loop, settle, t, &t->stop, &err), STATUS_OK);
	loop_timer_stop(t->loop, &t->timer);
}

static void wait_for_end(const struct stage *t)
{
	struct pollfd ended = {.fd = t->child.pidfd, .events = POLLIN};
	assert_int_equal(poll(&ended, 1, -1), 1);
}

// It is kept until it can be collected, and looked for without a busy loop.
static void one_that_is_let_go_is_collected_once_its_tracer_is_gone(void **state)
{
	struct stage t;
	(void)state;
	begin(&t);
	child_abandon(&t.child, &t.children);
	run(&t, true, LOOKS_US);
	assert_int_equal(t.children.count, 1);
	assert_true(t.settled < 50);
	end_tracer(&t);
	run(&t, true, GIVE_UP_US);
	assert_int_equal(t.children.count, 0);
	end(&t);
}

static void one_that_has_ended_by_itself_too(void **state)
{
	struct stage t;
	char how[64];
	(void)state;
	begin(&t);
	child_kill(&t.child);
	wait_for_end(&t);
	assert_int_equal(child_reap(&t.child, &t.children, how, sizeof how), 0);
	assert_string_equal(how, "ended");
	assert_int_equal(t.child.pid, 0);
	assert_int_equal(t.child.pidfd, -1);
	assert_int_equal(t.children.count, 1);
	end_tracer(&t);
	run(&t, true, GIVE_UP_US);
	assert_int_equal(t.children.count, 0);
	end(&t);
}

static void at_the_daemons_end_nobody_waits_for_its_tracer(void **state)
{
	struct stage t;
	(void)state;
	begin(&t);
	child_abandon(&t.child, &t.children);
	run(&t, true, LOOKS_US);
	children_finish(&t.children);
	assert_int_equal(t.children.count, 0);
	end_tracer(&t);
	assert_int_equal(waitpid(t.pid, NULL, 0), t.pid);
	end(&t);
}

// The same without a tracer.
static void others_are_collected_at_once(void **state)
{
	struct stage t;
	char how[64];
	(void)state;
	begin(&t);
	end_tracer(&t);
	child_kill(&t.child);
	wait_for_end(&t);
	assert_int_equal(child_reap(&t.child, &t.children, how, sizeof how), SIGKILL);
	assert_string_equal(how, "killed by signal 9");
	assert_int_equal(t.children.count, 0);
	end(&t);
}

int main(int argc, char **argv)
{
	if (argc > 1 && strcmp(argv[1], "child") == 0)
		return be_child();
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(one_that_is_let_go_is_collected_once_its_tracer_is_gone),
	    cmocka_unit_test(one_that_has_ended_by_itself_too),
	    cmocka_unit_test(at_the_daemons_end_nobody_waits_for_its_tracer),
	    cmocka_unit_test(others_are_collected_at_once),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
