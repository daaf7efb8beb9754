// The connection: its socket, its two buffers, its end.
#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "clients/libcandil/private.h"

candil_status client_fail(struct candil_error *error, candil_status code, const char *format, ...)
{
	if (error) {
		va_list args;
		va_start(args, format);
		error->code = code;
		vsnprintf(error->text, sizeof(error->text), format, args);
		va_end(args);
	}
	return code;
}

void client_break(candil_client *client, candil_status code, const char *format, ...)
{
	if (client->broken.code != CANDIL_STATUS_OK)
		return;
	va_list args;
	va_start(args, format);
	client->broken.code = code;
	vsnprintf(client->broken.text, sizeof(client->broken.text), format, args);
	va_end(args);
	shutdown(client->fd, SHUT_RDWR);
}

static candil_status broken_status(const candil_client *client, struct candil_error *error)
{
	if (error)
		*error = client->broken;
	return client->broken.code;
}

candil_status client_queue(candil_client *client, const void *bytes, size_t count, int fd, struct candil_error *error)
{
	if (client->broken.code != CANDIL_STATUS_OK)
		return broken_status(client, error);
	if (client->out_start > 0) {
		memmove(client->out, client->out + client->out_start, client->out_end - client->out_start);
		for (uint32_t i = 0; i < client->out_fd_count; i++)
			client->out_fds[i].at -= client->out_start;
		client->out_end -= client->out_start;
		client->out_start = 0;
	}
	if (count > OUT_BYTES_MAX - client->out_end || (fd >= 0 && client->out_fd_count == OUT_FDS_MAX))
		return client_fail(error, CANDIL_STATUS_LIMIT,
				   "too many requests wait to be sent; let candil_process send some");
	if (client->out_end + count > client->out_capacity) {
		size_t capacity = 2 * (client->out_end + count);
		uint8_t *bigger = realloc(client->out, capacity);
		if (!bigger)
			return client_fail(error, CANDIL_STATUS_MEMORY, "out of memory for a request of %zu bytes", count);
		client->out = bigger;
		client->out_capacity = capacity;
	}
	if (fd >= 0) {
		client->out_fds[client->out_fd_count].at = client->out_end;
		client->out_fds[client->out_fd_count++].fd = fd;
	}
	memcpy(client->out + client->out_end, bytes, count);
	client->out_end += count;
	return CANDIL_STATUS_OK;
}

// One sendmsg: up to the next byte that has a descriptor, which itself begins a sendmsg of its own.
static ssize_t send_some(candil_client *client, bool *with_fd)
{
	size_t end = client->out_end;
	int fd = -1;
	for (uint32_t i = 0; i < client->out_fd_count; i++) {
		if (client->out_fds[i].at == client->out_start) {
			fd = client->out_fds[i].fd;
		} else {
			end = client->out_fds[i].at;
			break;
		}
	}
	struct iovec part = {client->out + client->out_start, end - client->out_start};
	struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
	union {
		struct cmsghdr align;
		char bytes[CMSG_SPACE(sizeof(int))];
	} control;
	*with_fd = fd >= 0;
	if (fd >= 0) {
		memset(&control, 0, sizeof(control));
		message.msg_control = control.bytes;
		message.msg_controllen = sizeof(control.bytes);
		struct cmsghdr *c = CMSG_FIRSTHDR(&message);
		c->cmsg_level = SOL_SOCKET;
		c->cmsg_type = SCM_RIGHTS;
		c->cmsg_len = CMSG_LEN(sizeof(int));
		memcpy(CMSG_DATA(c), &fd, sizeof(int));
	}
	return sendmsg(client->fd, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
}

static void close_out_fds(candil_client *client)
{
	for (uint32_t i = 0; i < client->out_fd_count; i++)
		close(client->out_fds[i].fd);
	client->out_fd_count = 0;
}

// A peer that closed may have said why before: sending stops, what has arrived is still read.
static void send_all(candil_client *client)
{
	while (client->out_start < client->out_end) {
		bool with_fd;
		ssize_t sent = send_some(client, &with_fd);
		if (sent < 0 && errno == EINTR)
			continue;
		if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
			return;
		if (sent < 0 && (errno == EPIPE || errno == ECONNRESET)) {
			close_out_fds(client);
			client->out_start = client->out_end;
			return;
		}
		if (sent < 0) {
			client_break(client, CANDIL_STATUS_IO, "cannot send to the daemon: %s", strerror(errno));
			return;
		}
		if (with_fd && sent > 0) {
			close(client->out_fds[0].fd);
			client->out_fd_count--;
			memmove(client->out_fds, client->out_fds + 1, client->out_fd_count * sizeof(client->out_fds[0]));
		}
		client->out_start += (size_t)sent;
	}
}

static void receive_all(candil_client *client)
{
	if (client->in_start > 0) {
		memmove(client->in, client->in + client->in_start, client->in_end - client->in_start);
		client->in_end -= client->in_start;
		client->in_start = 0;
	}
	while (!client->eof && client->in_end < IN_BYTES) {
		ssize_t got = recv(client->fd, client->in + client->in_end, IN_BYTES - client->in_end, MSG_DONTWAIT);
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
			return;
		if (got < 0 && errno != ECONNRESET) {
			client_break(client, CANDIL_STATUS_IO, "cannot read from the daemon: %s", strerror(errno));
			return;
		}
		if (got <= 0)
			client->eof = true;
		else
			client->in_end += (size_t)got;
	}
}

candil_status candil_process(candil_client *client, struct candil_error *error)
{
	if (client->broken.code == CANDIL_STATUS_OK) {
		send_all(client);
		receive_all(client);
	}
	if (client->broken.code != CANDIL_STATUS_OK && !request_any_open(client))
		return broken_status(client, error);
	return CANDIL_STATUS_OK;
}

candil_status client_wait(candil_client *client, int timeout_ms, struct candil_error *error)
{
	if (client->broken.code != CANDIL_STATUS_OK || client->eof)
		return candil_process(client, error);
	struct pollfd p = {client->fd, (short)(POLLIN | (candil_wants_write(client) ? POLLOUT : 0)), 0};
	int ready;
	do
		ready = poll(&p, 1, timeout_ms);
	while (ready < 0 && errno == EINTR);
	if (ready == 0)
		client_break(client, CANDIL_STATUS_IO, "the daemon has said nothing for %d ms", timeout_ms);
	else if (ready < 0)
		client_break(client, CANDIL_STATUS_IO, "cannot wait for the daemon: %s", strerror(errno));
	return candil_process(client, error);
}

int candil_fd(const candil_client *client)
{
	return client->fd;
}

bool candil_wants_write(const candil_client *client)
{
	return client->broken.code == CANDIL_STATUS_OK && client->out_start < client->out_end;
}

const struct candil_server *candil_server(const candil_client *client)
{
	return &client->server;
}

void candil_set_timeout(candil_client *client, uint32_t milliseconds)
{
	client->timeout_ms = milliseconds;
}

void candil_disconnect(candil_client *client)
{
	if (!client)
		return;
	for (size_t i = 0; i < 2u * OPEN_REQUESTS; i++)
		request_close(&client->requests[i]);
	close_out_fds(client);
	close(client->fd);
	free(client->event_image);
	free(client->out);
	free(client);
}

bool candil_default_address(char *path, size_t capacity)
{
	const char *folder = getenv("XDG_RUNTIME_DIR");
	if (!folder || !*folder)
		return false;
	int length = snprintf(path, capacity, "%s/candil.sock", folder);
	return length > 0 && (size_t)length < capacity;
}

// Say hello and wait for the answer.
static candil_status greet(candil_client *client, struct candil_error *error)
{
	candil_Hello hello = {.version_min = CANDIL_VERSION, .version_max = CANDIL_VERSION};
	snprintf(hello.client, sizeof(hello.client), "libcandil %s", CANDIL_VERSION_STRING);
	struct request *request;
	candil_status status = request_submit(client, MESSAGE_HELLO, candil_Hello_fields, &hello, -1, true, &request, error);
	struct candil_event event;
	while (status == CANDIL_STATUS_OK && !client->greeted) {
		status = client_wait(client, HELLO_TIMEOUT_MS, error);
		while (candil_next_event(client, &event))
			;
		if (status == CANDIL_STATUS_OK && client->broken.code != CANDIL_STATUS_OK)
			status = broken_status(client, error);
	}
	// No one that speaks this protocol is there: to the caller that is a failure to connect.
	if (status == CANDIL_STATUS_IO) {
		status = CANDIL_STATUS_CONNECT;
		if (error)
			error->code = status;
	}
	return status;
}

candil_status candil_connect_fd(int fd, candil_client **client, struct candil_error *error)
{
	*client = NULL;
	candil_client *made = calloc(1, sizeof(*made));
	if (!made) {
		close(fd);
		return client_fail(error, CANDIL_STATUS_MEMORY, "out of memory for a connection");
	}
	made->fd = fd;
	candil_status status = greet(made, error);
	if (status == CANDIL_STATUS_OK)
		*client = made;
	else
		candil_disconnect(made);
	return status;
}

candil_status candil_connect(const char *address, candil_client **client, struct candil_error *error)
{
	*client = NULL;
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	char fallback[sizeof(to.sun_path)];
	if (!address) {
		if (!candil_default_address(fallback, sizeof(fallback)))
			return client_fail(error, CANDIL_STATUS_CONNECT,
					   "no address was given and XDG_RUNTIME_DIR is not set; name the daemon's socket");
		address = fallback;
	}
	if (strncmp(address, "unix:", 5) == 0)
		address += 5;
	size_t length = strlen(address);
	if (length == 0 || length >= sizeof(to.sun_path))
		return client_fail(error, CANDIL_STATUS_BAD_ARGUMENT, "a socket's path has 1 to %zu bytes, this one has %zu",
				   sizeof(to.sun_path) - 1, length);
	memcpy(to.sun_path, address, length);
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return client_fail(error, CANDIL_STATUS_CONNECT, "cannot make a socket: %s", strerror(errno));
	// Bounds the wait for a daemon whose queue of connections is full.
	struct timeval limit = {HELLO_TIMEOUT_MS / 1000, 0};
	setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit));
	int result;
	do
		result = connect(fd, (const struct sockaddr *)&to, sizeof(to));
	while (result < 0 && errno == EINTR);
	if (result < 0) {
		const bool nobody = errno == ENOENT || errno == ECONNREFUSED;
		candil_status status = client_fail(error, CANDIL_STATUS_CONNECT, "no daemon answers at %s: %s%s", address,
						   strerror(errno), nobody ? "; candild --socket starts one there" : "");
		close(fd);
		return status;
	}
	return candil_connect_fd(fd, client, error);
}
