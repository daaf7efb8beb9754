#include "clients/cli/interrupt.h"

#include <errno.h>
#include <signal.h>
#include <time.h>

static volatile sig_atomic_t seen; // global because a signal handler can reach nothing else
static sigset_t mask_before;
static struct sigaction before_int, before_term, before_hup, before_pipe;

static void interrupt_note(int number)
{
	if (seen++ > 0) {
		signal(number, SIG_DFL);
		raise(number);
	}
}

void interrupt_begin(void)
{
	sigset_t held;
	struct sigaction action = {.sa_handler = interrupt_note};
	sigemptyset(&action.sa_mask);
	sigemptyset(&held);
	sigaddset(&held, SIGINT);
	sigaddset(&held, SIGTERM);
	sigaddset(&held, SIGHUP);
	sigprocmask(SIG_BLOCK, &held, &mask_before);
	sigaction(SIGINT, &action, &before_int);
	sigaction(SIGTERM, &action, &before_term);
	sigaction(SIGHUP, &action, &before_hup);
	sigaction(SIGPIPE, &(struct sigaction){.sa_handler = SIG_IGN}, &before_pipe);
	if (before_hup.sa_handler == SIG_IGN)
		sigaction(SIGHUP, &before_hup, NULL); // nohup: a lost terminal must not end the program
}

void interrupt_end(void)
{
	sigaction(SIGINT, &before_int, NULL);
	sigaction(SIGTERM, &before_term, NULL);
	sigaction(SIGHUP, &before_hup, NULL);
	sigaction(SIGPIPE, &before_pipe, NULL);
	sigprocmask(SIG_SETMASK, &mask_before, NULL);
}

bool interrupt_seen(void)
{
	return seen != 0;
}

int interrupt_poll(struct pollfd *fds, nfds_t count, long milliseconds)
{
	const struct timespec most = {milliseconds / 1000, milliseconds % 1000 * 1000000};
	return ppoll(fds, count, &most, &mask_before);
}

void interrupt_pause(long milliseconds)
{
	interrupt_poll(NULL, 0, milliseconds);
}

bool interrupt_wait(candil_client *client, struct candil_event *event, candil_status *status, struct candil_error *error)
{
	const bool before = interrupt_seen();
	*status = CANDIL_STATUS_OK;
	for (;;) {
		if (candil_next_event(client, event))
			return true;
		struct pollfd p = {candil_fd(client), (short)(POLLIN | (candil_wants_write(client) ? POLLOUT : 0)), 0};
		if (ppoll(&p, 1, NULL, &mask_before) < 0 && errno == EINTR && interrupt_seen() && !before)
			return false;
		*status = candil_process(client, error);
		if (*status != CANDIL_STATUS_OK)
			return false;
	}
}
