// Several renders on one connection, in a poll loop of this program's own: multiplex SOCKET SCENE. Exit status 0 if every
// request got its own answers: two images of different sizes, one cancelled render, one refused one, the counters.
#include <poll.h>
#include <stdio.h>
#include <string.h>

#include "clients/libcandil/candil.h"

enum { LARGE, SMALL, CANCELLED, REFUSED, STATS, REQUESTS };

struct seen {
	uint32_t id;
	unsigned accepted, finals, ends;
	struct candil_image image;
	enum candil_event_kind last;
	candil_status status;
};

static candil_status submit_all(candil_client *client, struct seen seen[REQUESTS], struct candil_error *error)
{
	struct candil_render_request request;
	candil_render_request_init(&request);
	request.scene = "multiplex";
	request.has_camera = true;
	request.eye = (struct candil_vec3){0, 1, 4};
	request.target.y = request.up.y = 1;
	request.vfov_degrees = 40;
	request.width = request.height = 768;
	request.samples = 1;
	candil_status status = candil_submit_render(client, &request, &seen[LARGE].id, error);
	request.width = request.height = 16;
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_render(client, &request, &seen[SMALL].id, error);
	request.samples = 1u << 20;
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_render(client, &request, &seen[CANCELLED].id, error);
	request.scene = "no-such-scene";
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_render(client, &request, &seen[REFUSED].id, error);
	if (status == CANDIL_STATUS_OK)
		status = candil_submit_stats(client, &seen[STATS].id, error);
	return status;
}

static void take(candil_client *client, const struct candil_event *event, struct seen seen[REQUESTS])
{
	for (int i = 0; i < REQUESTS; i++) {
		struct seen *s = &seen[i];
		if (s->id != event->id)
			continue;
		s->last = event->kind;
		s->ends += event->ends_request;
		s->accepted += event->kind == CANDIL_EVENT_ACCEPTED;
		if (event->kind == CANDIL_EVENT_ACCEPTED && i == CANCELLED)
			candil_cancel(client, s->id, NULL);
		if (event->kind == CANDIL_EVENT_ERROR)
			s->status = event->u.error.code;
		if (event->kind == CANDIL_EVENT_IMAGE && event->u.image.final) {
			s->finals++;
			s->image = event->u.image;
			candil_keep_image(client, &event->u.image);
		}
	}
}

static unsigned ended(const struct seen seen[REQUESTS])
{
	unsigned sum = 0;
	for (int i = 0; i < REQUESTS; i++)
		sum += seen[i].ends;
	return sum;
}

static bool loop(candil_client *client, struct seen seen[REQUESTS], struct candil_error *error)
{
	struct candil_event event;
	while (ended(seen) < REQUESTS) {
		struct pollfd p = {candil_fd(client), (short)(POLLIN | (candil_wants_write(client) ? POLLOUT : 0)), 0};
		if (poll(&p, 1, 60000) <= 0)
			return false;
		if (candil_process(client, error) != CANDIL_STATUS_OK)
			return false;
		while (candil_next_event(client, &event))
			take(client, &event, seen);
	}
	return true;
}

static bool image_is(const struct seen *s, uint32_t side)
{
	static const uint8_t exr[4] = {0x76, 0x2F, 0x31, 0x01};
	return s->last == CANDIL_EVENT_DONE && s->accepted == 1 && s->finals == 1 && s->image.width == side &&
	       s->image.bytes > 4 && memcmp(s->image.data, exr, 4) == 0;
}

int main(int argc, char **argv)
{
	static struct seen seen[REQUESTS];
	struct candil_error error = {CANDIL_STATUS_OK, ""};
	candil_client *client = NULL;
	if (argc != 3)
		return 2;
	bool good = candil_connect(argv[1], &client, &error) == CANDIL_STATUS_OK &&
		    candil_load_file(client, "multiplex", argv[2], NULL, &error) == CANDIL_STATUS_OK &&
		    submit_all(client, seen, &error) == CANDIL_STATUS_OK && loop(client, seen, &error);
	if (!good)
		fprintf(stderr, "multiplex: %s\n", error.text);
	good = good && image_is(&seen[LARGE], 768) && image_is(&seen[SMALL], 16) &&
	       seen[CANCELLED].status == CANDIL_STATUS_CANCELLED && seen[CANCELLED].finals == 0 &&
	       seen[REFUSED].status == CANDIL_STATUS_SCENE_NOT_FOUND && seen[STATS].last == CANDIL_EVENT_STATS;
	good = good && candil_unload(client, "multiplex", &error) == CANDIL_STATUS_OK;
	for (int i = 0; i < REQUESTS; i++)
		candil_free(seen[i].image.data);
	candil_disconnect(client);
	return good ? 0 : 1;
}
