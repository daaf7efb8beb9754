// bench_latency SOCKET SCENE: what a client waits for, over one open connection to a running daemon.
//
//   16 × 16, 1 sample     the least frame: request, one slice, encoding, reply
//   64 × 64, 4 samples    a preview, alone and while another connection's 512 × 512 frame of 4096 samples is traced
//
// The daemon should be idle and the scene small. Prints a table: median, 95th percentile, and the ratio of the previews.
// With
// --least N only the first is asked for, N times, and the milliseconds of each are printed, for programs that compare.
#include <candil.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define ROUNDS 200
#define WARM_UP 5
#define SCENE "bench-latency"

static void must(candil_status status, const struct candil_error *error)
{
	if (status == CANDIL_STATUS_OK)
		return;
	fprintf(stderr, "bench_latency: %s (%s)\n", error->text, candil_status_name(error->code));
	exit(1);
}

static double now_ms(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

static int ascending(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

struct figures {
	double median, p95;
};

static struct candil_render_request request_of(uint32_t side, uint32_t samples)
{
	struct candil_render_request r;
	candil_render_request_init(&r);
	r.scene = SCENE;
	r.width = r.height = side;
	r.samples = samples;
	r.format = CANDIL_FORMAT_PNG;
	return r;
}

static double time_one(candil_client *client, const struct candil_render_request *request)
{
	struct candil_render_result result;
	struct candil_error error;
	const double start = now_ms();
	must(candil_render(client, request, NULL, &result, &error), &error);
	const double ms = now_ms() - start;
	candil_free(result.image.data);
	return ms;
}

static struct figures measure(candil_client *client, uint32_t side, uint32_t samples)
{
	static double ms[ROUNDS];
	const struct candil_render_request request = request_of(side, samples);
	for (int i = 0; i < WARM_UP; i++)
		time_one(client, &request);
	for (int i = 0; i < ROUNDS; i++)
		ms[i] = time_one(client, &request);
	qsort(ms, ROUNDS, sizeof *ms, ascending);
	return (struct figures){ms[ROUNDS / 2], ms[ROUNDS * 95 / 100]};
}

// Begin a long frame on a connection of its own and wait until it is under way.
static candil_client *start_long_frame(const char *socket)
{
	candil_client *client;
	struct candil_error error;
	struct candil_event event;
	uint32_t id;
	const struct candil_render_request request = request_of(512, 4096);
	must(candil_connect(socket, &client, &error), &error);
	must(candil_submit_render(client, &request, &id, &error), &error);
	for (bool begun = false; !begun;) {
		struct pollfd p = {.fd = candil_fd(client),
				   .events = (short)(candil_wants_write(client) ? POLLIN | POLLOUT : POLLIN)};
		poll(&p, 1, 1000);
		must(candil_process(client, &error), &error);
		while (candil_next_event(client, &event))
			begun = begun || event.kind == CANDIL_EVENT_PROGRESS;
	}
	return client;
}

static void print_least(candil_client *client, long count)
{
	const struct candil_render_request request = request_of(16, 1);
	for (int i = 0; i < WARM_UP; i++)
		time_one(client, &request);
	for (long i = 0; i < count; i++)
		printf("%.4f\n", time_one(client, &request));
}

static void print_table(candil_client *client, const char *socket)
{
	struct candil_error error;
	struct candil_stats stats;
	const struct figures least = measure(client, 16, 1);
	const struct figures alone = measure(client, 64, 4);
	must(candil_stats(client, &stats, &error), &error);
	candil_client *other = start_long_frame(socket);
	const struct figures beside = measure(client, 64, 4);
	candil_disconnect(other); // which cancels the frame
	printf("device: %s, slices of %u ms, %d requests each\n\n", stats.device, (unsigned)stats.slice_ms, ROUNDS);
	printf("| request | median ms | p95 ms |\n| --- | ---: | ---: |\n");
	printf("| 16 x 16, 1 sample | %.2f | %.2f |\n", least.median, least.p95);
	printf("| 64 x 64, 4 samples, alone | %.2f | %.2f |\n", alone.median, alone.p95);
	printf("| the same beside a 4096-sample frame | %.2f | %.2f |\n", beside.median, beside.p95);
	printf("\nbeside minus alone: p95 to p95 %.1f slices, p95 to median %.1f\n",
	       (beside.p95 - alone.p95) / stats.slice_ms, (beside.p95 - alone.median) / stats.slice_ms);
}

int main(int argc, char **argv)
{
	candil_client *client;
	struct candil_error error;
	const bool least = argc == 5 && !strcmp(argv[1], "--least");
	if (argc != 3 && !least) {
		fprintf(stderr, "usage: bench_latency [--least N] SOCKET SCENE\n");
		return 2;
	}
	const char *socket = argv[argc - 2];
	must(candil_connect(socket, &client, &error), &error);
	must(candil_load_file(client, SCENE, argv[argc - 1], NULL, &error), &error);
	if (least)
		print_least(client, strtol(argv[2], NULL, 10));
	else
		print_table(client, socket);
	must(candil_unload(client, SCENE, &error), &error);
	candil_disconnect(client);
	return 0;
}
