// A client of the library: a connection and the requests that are open on it.
#ifndef CANDIL_LIBCANDIL_CLIENT_H
#define CANDIL_LIBCANDIL_CLIENT_H

#include "clients/libcandil/connection.h"
#include "clients/libcandil/request.h"

struct candil_client {
	struct connection connection;
	struct request_table requests;
	uint32_t timeout_ms; // of blocking calls; 0: none
	uint8_t *event_image; // bytes of the last IMAGE event, unless the caller keeps them
	bool greeted; // the daemon has answered the hello
	struct candil_server server;
};

// Wait until something can be sent or received, then candil_process. After `timeout_ms` (-1: never) without that the
// connection is over, with IO.
candil_status client_wait(candil_client *client, int timeout_ms, struct candil_error *error);

#endif
