#include "clients/libcandil/connection.h"

#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clients/libcandil/error.h"

void connection_init(struct connection *connection, int fd)
{
	connection->fd = fd;
}

void connection_break(struct connection *connection, candil_status code, const char *format, ...)
{
	if (connection->broken.code != CANDIL_STATUS_OK)
		return;
	va_list args;
	va_start(args, format);
	connection->broken.code = code;
	vsnprintf(connection->broken.text, sizeof(connection->broken.text), format, args);
	va_end(args);
	shutdown(connection->fd, SHUT_RDWR);
}

candil_status connection_status(const struct connection *connection, struct candil_error *error)
{
	if (error && connection->broken.code != CANDIL_STATUS_OK)
		*error = connection->broken;
	return connection->broken.code;
}

candil_status connection_queue(struct connection *connection, const void *bytes, size_t count, int fd,
			       struct candil_error *error)
{
	if (connection->broken.code != CANDIL_STATUS_OK)
		return connection_status(connection, error);
	if (connection->out_start > 0) {
		memmove(connection->out, connection->out + connection->out_start,
			connection->out_end - connection->out_start);
		for (uint32_t i = 0; i < connection->out_fd_count; i++)
			connection->out_fds[i].at -= connection->out_start;
		connection->out_end -= connection->out_start;
		connection->out_start = 0;
	}
	if (count > CONNECTION_OUT_BYTES - connection->out_end ||
	    (fd >= 0 && connection->out_fd_count == CONNECTION_OUT_FDS))
		return error_set(error, CANDIL_STATUS_LIMIT,
				 "too many requests wait to be sent; let candil_process send some");
	if (connection->out_end + count > connection->out_capacity) {
		size_t capacity = 2 * (connection->out_end + count);
		uint8_t *bigger = realloc(connection->out, capacity);
		if (!bigger)
			return error_set(error, CANDIL_STATUS_MEMORY, "out of memory for a request of %zu bytes", count);
		connection->out = bigger;
		connection->out_capacity = capacity;
	}
	if (fd >= 0) {
		connection->out_fds[connection->out_fd_count].at = connection->out_end;
		connection->out_fds[connection->out_fd_count++].fd = fd;
	}
	memcpy(connection->out + connection->out_end, bytes, count);
	connection->out_end += count;
	return CANDIL_STATUS_OK;
}

// Send once. A byte that a descriptor goes along with must begin a sendmsg, so what is sent ends before the next such byte.
static ssize_t send_some(struct connection *connection, bool *with_fd)
{
	size_t end = connection->out_end;
	int fd = -1;
	for (uint32_t i = 0; i < connection->out_fd_count; i++) {
		if (connection->out_fds[i].at == connection->out_start) {
			fd = connection->out_fds[i].fd;
		} else {
			end = connection->out_fds[i].at;
			break;
		}
	}
	struct iovec part = {connection->out + connection->out_start, end - connection->out_start};
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
	return sendmsg(connection->fd, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
}

static void close_out_fds(struct connection *connection)
{
	for (uint32_t i = 0; i < connection->out_fd_count; i++)
		close(connection->out_fds[i].fd);
	connection->out_fd_count = 0;
}

// Send until the socket is full. A peer that has closed may have said why before it did: then sending stops, and what has
// arrived is still read.
static void send_all(struct connection *connection)
{
	while (connection->out_start < connection->out_end) {
		bool with_fd;
		ssize_t sent = send_some(connection, &with_fd);
		if (sent < 0 && errno == EINTR)
			continue;
		if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
			return;
		if (sent < 0 && (errno == EPIPE || errno == ECONNRESET)) {
			close_out_fds(connection);
			connection->out_start = connection->out_end;
			return;
		}
		if (sent < 0) {
			connection_break(connection, CANDIL_STATUS_IO, "cannot send to the daemon: %s", strerror(errno));
			return;
		}
		if (with_fd && sent > 0) {
			close(connection->out_fds[0].fd);
			connection->out_fd_count--;
			memmove(connection->out_fds, connection->out_fds + 1,
				connection->out_fd_count * sizeof(connection->out_fds[0]));
		}
		connection->out_start += (size_t)sent;
	}
}

static void receive_all(struct connection *connection)
{
	if (connection->in_start > 0) {
		memmove(connection->in, connection->in + connection->in_start, connection->in_end - connection->in_start);
		connection->in_end -= connection->in_start;
		connection->in_start = 0;
	}
	while (!connection->eof && connection->in_end < CONNECTION_IN_BYTES) {
		ssize_t got = recv(connection->fd, connection->in + connection->in_end,
				   CONNECTION_IN_BYTES - connection->in_end, MSG_DONTWAIT);
		if (got < 0 && errno == EINTR)
			continue;
		if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
			return;
		if (got < 0 && errno != ECONNRESET) {
			connection_break(connection, CANDIL_STATUS_IO, "cannot read from the daemon: %s", strerror(errno));
			return;
		}
		if (got <= 0)
			connection->eof = true;
		else
			connection->in_end += (size_t)got;
	}
}

void connection_finish(struct connection *connection)
{
	close_out_fds(connection);
	close(connection->fd);
	free(connection->out);
}

bool connection_wants_write(const struct connection *connection)
{
	return connection->broken.code == CANDIL_STATUS_OK && connection->out_start < connection->out_end;
}

void connection_exchange(struct connection *connection)
{
	if (connection->broken.code != CANDIL_STATUS_OK)
		return;
	send_all(connection);
	receive_all(connection);
}

void connection_wait(struct connection *connection, int timeout_ms)
{
	if (connection->broken.code != CANDIL_STATUS_OK || connection->eof)
		return;
	struct pollfd p = {connection->fd, (short)(POLLIN | (connection_wants_write(connection) ? POLLOUT : 0)), 0};
	int ready;
	do
		ready = poll(&p, 1, timeout_ms);
	while (ready < 0 && errno == EINTR);
	if (ready == 0)
		connection_break(connection, CANDIL_STATUS_IO, "the daemon has said nothing for %d ms", timeout_ms);
	else if (ready < 0)
		connection_break(connection, CANDIL_STATUS_IO, "cannot wait for the daemon: %s", strerror(errno));
}

// Take one whole message off what has arrived. false: there is none yet.
static bool take_message(struct connection *connection, struct header *header, const uint8_t **body)
{
	const size_t there = connection->in_end - connection->in_start;
	if (there < CANDIL_HEADER_BYTES)
		return false;
	const uint8_t *at = connection->in + connection->in_start;
	const enum status status = header_decode(at, header);
	if (status != STATUS_OK) {
		connection_break(connection, (candil_status)status, "what answers does not speak candil's protocol (%s)",
				 status_name(status));
		return false;
	}
	if (there < CANDIL_HEADER_BYTES + (size_t)header->length)
		return false;
	connection->in_start += CANDIL_HEADER_BYTES + (size_t)header->length;
	*body = at + CANDIL_HEADER_BYTES;
	return true;
}

bool connection_next(struct connection *connection, struct header *header, const uint8_t **body)
{
	if (connection->broken.code != CANDIL_STATUS_OK)
		return false;
	if (take_message(connection, header, body))
		return true;
	if (connection->eof)
		connection_break(connection, CANDIL_STATUS_IO, "the daemon closed the connection");
	return false;
}
