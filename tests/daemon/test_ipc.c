// Datagrams between processes, descriptors that come along unasked, and memory to pass.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
// cmocka wants the four above first
#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/base/ipc.h"
#include "server/base/memfd.h"

static void send_with(int socket, const int *fds, size_t count)
{
	char byte = 'x';
	struct iovec part = {.iov_base = &byte, .iov_len = 1};
	union {
		char space[CMSG_SPACE(8 * sizeof(int))];
		struct cmsghdr align;
	} control = {0};
	struct msghdr m = {.msg_iov = &part,
			   .msg_iovlen = 1,
			   .msg_control = control.space,
			   .msg_controllen = CMSG_SPACE(count * sizeof(int))};
	struct cmsghdr *c = CMSG_FIRSTHDR(&m);
	c->cmsg_level = SOL_SOCKET;
	c->cmsg_type = SCM_RIGHTS;
	c->cmsg_len = CMSG_LEN(count * sizeof(int));
	memcpy(CMSG_DATA(c), fds, count * sizeof(int));
	assert_int_equal(sendmsg(socket, &m, 0), 1);
}

// The lowest number that is free: it rises with each descriptor that is forgotten.
static int lowest_free(void)
{
	int fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
	assert_true(fd >= 0);
	close(fd);
	return fd;
}

static void more_than_one_descriptor_is_refused_and_none_is_kept(void **state)
{
	int pair[2], fd;
	char buffer[16];
	size_t bytes;
	(void)state;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair), 0);
	const int before = lowest_free();
	const int fds[8] = {0, 1, 2, 0, 1, 2, 0, 1};
	for (size_t count = 2; count <= 8; count++) {
		send_with(pair[0], fds, count);
		assert_int_equal(ipc_receive(pair[1], buffer, sizeof buffer, &bytes, &fd, NULL), STATUS_INTERNAL);
		assert_int_equal(fd, -1);
		assert_int_equal(lowest_free(), before);
	}
	send_with(pair[0], fds, 1);
	assert_int_equal(ipc_receive(pair[1], buffer, sizeof buffer, &bytes, &fd, NULL), STATUS_OK);
	assert_int_equal(bytes, 1);
	assert_int_equal(fd, before);
	assert_int_equal(fcntl(fd, F_GETFD), FD_CLOEXEC);
	close(fd);
	close(pair[0]);
	close(pair[1]);
}

// Without a descriptor left the message comes whole, and says that its own is lost.
static void one_that_there_is_no_place_for_is_lost_and_not_its_message(void **state)
{
	int pair[2], fd, taken[1];
	char buffer[16];
	size_t bytes;
	struct rlimit before, none;
	(void)state;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair), 0);
	assert_int_equal(getrlimit(RLIMIT_NOFILE, &before), 0);
	none = (struct rlimit){.rlim_cur = (rlim_t)lowest_free(), .rlim_max = before.rlim_max};
	taken[0] = pair[0];
	send_with(pair[0], taken, 1);
	send_with(pair[0], taken, 1);
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &none), 0);
	assert_int_equal(ipc_receive(pair[1], buffer, sizeof buffer, &bytes, &fd, NULL), STATUS_OK);
	assert_int_equal(setrlimit(RLIMIT_NOFILE, &before), 0);
	assert_int_equal(bytes, 1);
	assert_int_equal(fd, IPC_LOST_FD);
	assert_int_equal(ipc_receive(pair[1], buffer, sizeof buffer, &bytes, &fd, NULL), STATUS_OK);
	assert_true(fd >= 0);
	close(fd);
	close(pair[0]);
	close(pair[1]);
}

// A peer that goes before it has read everything leaves no message: nothing is taken for one, least of all a descriptor of
// the message before, of which the stack may still tell.
static void a_peer_that_goes_with_unread_messages_has_closed(void **state)
{
	int pair[2], fd;
	char buffer[16] = {0};
	size_t bytes;
	const int null = 0;
	(void)state;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair), 0);
	send_with(pair[1], &null, 1);
	assert_int_equal(ipc_send(pair[1], buffer, 1, -1, NULL), STATUS_OK);
	send_with(pair[0], &null, 1);
	assert_int_equal(ipc_receive(pair[1], buffer, sizeof buffer, &bytes, &fd, NULL), STATUS_OK);
	close(fd);
	close(pair[0]);
	assert_int_equal(ipc_receive(pair[1], buffer, sizeof buffer, &bytes, &fd, NULL), STATUS_OK);
	assert_int_equal(bytes, 0);
	assert_int_equal(fd, -1);
	close(pair[1]);
}

static void a_build_tells_the_size_of_every_message_it_may_get_wrong(void **state)
{
	const size_t sizes[] = {sizeof(struct ipc_begin), sizeof(struct ipc_read), sizeof(struct ipc_step),
				sizeof(struct ipc_pilot), sizeof(struct ipc_piloted)};
	char size[32], build[128];
	(void)state;
	snprintf(build, sizeof build, "%s.", ipc_build());
	for (unsigned i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		snprintf(size, sizeof size, "%zu.", sizes[i]);
		assert_non_null(strstr(build, size));
	}
	// It fits where messages have it.
	assert_true(strlen(ipc_build()) < sizeof((struct ipc_loaded *)0)->build - 1);
}

static void a_size_that_no_memory_has_is_not_the_limits_fault(void **state)
{
	static const size_t sizes[] = {0, (size_t)INT64_MAX + 1, SIZE_MAX};
	(void)state;
	for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
		struct error err;
		int fd;
		void *map;
		errno = EFBIG; // of a call before
		assert_int_equal(memfd_create_mapped("test", sizes[i], &fd, &map, &err), STATUS_MEMORY);
		assert_non_null(strstr(err.text, strerror(EINVAL)));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(more_than_one_descriptor_is_refused_and_none_is_kept),
	    cmocka_unit_test(one_that_there_is_no_place_for_is_lost_and_not_its_message),
	    cmocka_unit_test(a_peer_that_goes_with_unread_messages_has_closed),
	    cmocka_unit_test(a_build_tells_the_size_of_every_message_it_may_get_wrong),
	    cmocka_unit_test(a_size_that_no_memory_has_is_not_the_limits_fault),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
