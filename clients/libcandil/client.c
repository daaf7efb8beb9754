#include "clients/libcandil/client.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include "candil.pb.h"
#include "clients/libcandil/error.h"
#include "clients/libcandil/submit.h"
#include "protocol/limits.h"

#define HELLO_TIMEOUT_MS (1000 * (int)LIMIT_HANG_SECONDS) // a busy machine may starve a daemon that begins

candil_status candil_process(candil_client *client, struct candil_error *error)
{
	const candil_status status = error_if_missing(client, "the client", error);
	if (status != CANDIL_STATUS_OK)
		return status;
	connection_exchange(&client->connection);
	// While a request is open, its ERROR event tells that the connection is over.
	if (request_any_audible(&client->requests))
		return CANDIL_STATUS_OK;
	return connection_status(&client->connection, error);
}

candil_status client_wait(candil_client *client, int timeout_ms, struct candil_error *error)
{
	connection_wait(&client->connection, timeout_ms);
	return candil_process(client, error);
}

int candil_fd(const candil_client *client)
{
	return client ? client->connection.fd : -1;
}

bool candil_wants_write(const candil_client *client)
{
	return client && connection_wants_write(&client->connection);
}

const struct candil_server *candil_server(const candil_client *client)
{
	return client ? &client->server : NULL;
}

void candil_set_timeout(candil_client *client, uint32_t milliseconds)
{
	if (client)
		client->timeout_ms = milliseconds;
}

void candil_disconnect(candil_client *client)
{
	if (!client)
		return;
	request_close_all(&client->requests);
	connection_finish(&client->connection);
	free(client->event_image);
	free(client);
}

bool candil_default_address(char *path, size_t capacity)
{
	const char *folder = getenv("XDG_RUNTIME_DIR");
	if (!path || !folder || !*folder)
		return false;
	int length = snprintf(path, capacity, "%s/candil.sock", folder);
	return length > 0 && (size_t)length < capacity;
}

// Say hello and wait for the answer.
static candil_status client_greet(candil_client *client, struct candil_error *error)
{
	candil_Hello hello = {.version_min = CANDIL_VERSION, .version_max = CANDIL_VERSION};
	snprintf(hello.client, sizeof(hello.client), "libcandil %s", CANDIL_VERSION_STRING);
	struct request *request;
	candil_status status = submit_message(client, MESSAGE_HELLO, candil_Hello_fields, &hello, -1, true, &request, error);
	struct candil_event event;
	while (status == CANDIL_STATUS_OK && !client->greeted) {
		status = client_wait(client, HELLO_TIMEOUT_MS, error);
		while (candil_next_event(client, &event))
			;
		if (status == CANDIL_STATUS_OK)
			status = connection_status(&client->connection, error);
	}
	// Whoever listens does not speak this protocol. To the caller that is a failure to connect.
	if (status == CANDIL_STATUS_IO) {
		status = CANDIL_STATUS_CONNECT;
		if (error)
			error->code = status;
	}
	return status;
}

// Whether a message could come and go by a descriptor. One that is closed, a file, a pipe or a socket that listens would be
// waited for in vain.
static bool is_connected_stream(int fd)
{
	int type = 0, listens = 1;
	socklen_t type_bytes = sizeof(type), listens_bytes = sizeof(listens), peer_bytes = sizeof(struct sockaddr_storage);
	struct sockaddr_storage peer;
	return getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_bytes) == 0 && type == SOCK_STREAM &&
	       getsockopt(fd, SOL_SOCKET, SO_ACCEPTCONN, &listens, &listens_bytes) == 0 && !listens &&
	       getpeername(fd, (struct sockaddr *)&peer, &peer_bytes) == 0;
}

candil_status candil_connect_fd(int fd, candil_client **client, struct candil_error *error)
{
	candil_status status = error_if_missing(client, "the client's place", error);
	candil_client *made = NULL;
	if (client)
		*client = NULL;
	if (status == CANDIL_STATUS_OK && !is_connected_stream(fd))
		status = error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "descriptor %d is no connected stream socket", fd);
	if (status == CANDIL_STATUS_OK && !(made = calloc(1, sizeof(*made))))
		status = error_set(error, CANDIL_STATUS_MEMORY, "out of memory for a connection");
	if (status != CANDIL_STATUS_OK) {
		if (fd >= 0)
			close(fd);
		return status;
	}
	connection_init(&made->connection, fd);
	status = client_greet(made, error);
	if (status == CANDIL_STATUS_OK)
		*client = made;
	else
		candil_disconnect(made);
	return status;
}

candil_status candil_connect(const char *address, candil_client **client, struct candil_error *error)
{
	if (!client)
		return error_if_missing(false, "the client's place", error);
	*client = NULL;
	struct sockaddr_un to = {.sun_family = AF_UNIX};
	char fallback[sizeof(to.sun_path)];
	if (!address) {
		if (!candil_default_address(fallback, sizeof(fallback)))
			return error_set(error, CANDIL_STATUS_CONNECT,
					 "no address was given and XDG_RUNTIME_DIR is not set; name the daemon's socket");
		address = fallback;
	}
	if (strncmp(address, "unix:", 5) == 0)
		address += 5;
	size_t length = strlen(address);
	if (length == 0 || length >= sizeof(to.sun_path))
		return error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "a socket's path has 1 to %zu bytes, this one has %zu",
				 sizeof(to.sun_path) - 1, length);
	memcpy(to.sun_path, address, length);
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (fd < 0)
		return error_set(error, CANDIL_STATUS_CONNECT, "cannot make a socket: %s", strerror(errno));
	// connect() waits while the daemon's queue of connections is full; this bounds the wait.
	struct timeval limit = {LIMIT_HANG_SECONDS, 0};
	setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof(limit));
	int result;
	do
		result = connect(fd, (const struct sockaddr *)&to, sizeof(to));
	while (result < 0 && errno == EINTR);
	if (result < 0) {
		const bool nobody = errno == ENOENT || errno == ECONNREFUSED;
		candil_status status = error_set(error, CANDIL_STATUS_CONNECT, "no daemon answers at %s: %s%s", address,
						 strerror(errno), nobody ? "; candild --socket starts one there" : "");
		close(fd);
		return status;
	}
	return candil_connect_fd(fd, client, error);
}
