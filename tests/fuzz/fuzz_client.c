// What a daemon may send to the client library: any bytes, while a render, a describe and a list are under way.
#include <stdint.h>
#include <sys/socket.h>
#include <unistd.h>

#include "clients/libcandil/candil.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void submit(candil_client *client)
{
	struct candil_render_request render;
	uint32_t id;
	candil_render_request_init(&render);
	render.scene = "scene";
	render.width = 64;
	render.height = 64;
	candil_submit_render(client, &render, &id, NULL);
	candil_submit_describe(client, "scene", &id, NULL);
	candil_submit_scenes(client, &id, NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	int pair[2];
	candil_client *client;
	struct candil_event event;
	// The whole input has to fit the socket: nobody reads it while it is written.
	if (size > 64 * 1024 || socketpair(AF_UNIX, SOCK_STREAM, 0, pair) != 0)
		return 0;
	if (size > 0 && write(pair[1], data, size) != (ssize_t)size)
		return 0;
	shutdown(pair[1], SHUT_WR);
	if (candil_connect_fd(pair[0], &client, NULL) == CANDIL_STATUS_OK) {
		submit(client);
		for (int i = 0; i < 100 && candil_process(client, NULL) == CANDIL_STATUS_OK; i++)
			while (candil_next_event(client, &event))
				continue;
		while (candil_next_event(client, &event))
			continue;
		candil_disconnect(client);
	}
	close(pair[1]);
	return 0;
}
