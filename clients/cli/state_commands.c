// ping, stats: the daemon itself.
#include <inttypes.h>

#include "clients/cli/cli.h"
#include "protocol/limits.h"

#define ANSWER_MS (1000u * LIMIT_HANG_SECONDS)

static json_t *ping_json(const struct candil_server *server, uint64_t us)
{
	return json_pack("{s:o,s:o,s:i,s:o,s:o,s:o,s:i}", "round_trip_us", cli_json_u64(us), "server",
			 cli_json_text(server->name), "version", (int)server->version, "max_message_bytes",
			 cli_json_u64(server->max_message_bytes), "max_pixels", cli_json_u64(server->max_pixels),
			 "max_samples_times_pixels", cli_json_u64(server->max_samples_times_pixels),
			 "max_jobs_per_connection", (int)server->max_jobs_per_connection);
}

static enum exit_code ask_ping(const struct cli *cli, candil_client *client, const char *argument)
{
	struct candil_error error;
	uint64_t us;
	(void)argument;
	candil_set_timeout(client, ANSWER_MS);
	if (candil_ping(client, &us, &error) != CANDIL_STATUS_OK)
		return cli_fail(cli, &error, stdout);
	if (cli->json)
		return cli_print_json(ping_json(candil_server(client), us), stdout, EXIT_DONE);
	printf("%s answers in %" PRIu64 " µs\n", candil_server(client)->name, us);
	return cli_flush(stdout, EXIT_DONE);
}

static enum exit_code run_ping(struct cli *cli, const struct command *self, int argc, char **argv)
{
	return cli_ask(cli, self, argc, argv, 0, ask_ping);
}

const struct command ping_command = {
    .name = "ping",
    .summary = "ask the daemon for a sign of life",
    .help = "Usage: candil ping [--connect ADDR] [--json]\n\n"
	    "Sends a few bytes to the daemon and waits for them to come back, 30 s at most.\n\n"
	    "--json: {\"round_trip_us\", \"server\", \"version\", \"max_message_bytes\", \"max_pixels\",\n"
	    "\"max_samples_times_pixels\", \"max_jobs_per_connection\"}\n",
    .run = run_ping,
};

static void print_stats(const struct candil_stats *s)
{
	if (s->device_error[0])
		printf("device       none: %s\n", s->device_error);
	else
		printf("device       %s, %.1f MiB in use\n", s->device, (double)s->device_bytes / 1048576.0);
	if (s->device_losses > 0)
		printf("             lost %" PRIu32 " time%s\n", s->device_losses, cli_s(s->device_losses));
	if (s->device_note[0])
		printf("             %s\n", s->device_note);
	printf("up           %.1f s, %" PRIu32 " ms slices, %" PRIu64 " done\n", (double)s->uptime_us * 1e-6, s->slice_ms,
	       s->slices);
	printf("connections  %" PRIu32 " of %" PRIu32 ", %" PRIu64 " bytes and %.1f MiB of images wait for them\n",
	       s->connections, s->max_connections, s->buffered_bytes, (double)s->image_bytes / 1048576.0);
	printf("jobs         %" PRIu32 " under way, %" PRIu64 " done, %" PRIu64 " failed, %" PRIu64 " cancelled\n", s->jobs,
	       s->jobs_done, s->jobs_failed, s->jobs_cancelled);
	printf("scenes       %" PRIu32 " of %" PRIu32 ", %.1f MiB\n", s->scenes, s->max_scenes,
	       (double)s->scene_bytes / 1048576.0);
	printf("worker       pid %" PRIu32 ", started %" PRIu32 " time%s, %" PRIu64 " validation error%s\n", s->worker_pid,
	       s->worker_starts, cli_s(s->worker_starts), s->validation_errors, cli_s(s->validation_errors));
	printf("loaders      %" PRIu32 " started, %" PRIu64 " failed\n", s->loader_starts, s->loader_failures);
}

static json_t *stats_json(const struct candil_stats *s)
{
	json_t *object = json_object();
#define PUT(field) json_object_set_new(object, #field, cli_json_u64(s->field))
	PUT(uptime_us);
	PUT(connections);
	PUT(jobs);
	PUT(jobs_done);
	PUT(jobs_failed);
	PUT(jobs_cancelled);
	PUT(slices);
	PUT(worker_starts);
	PUT(loader_starts);
	PUT(loader_failures);
	PUT(scenes);
	PUT(scene_bytes);
	PUT(buffered_bytes);
	PUT(image_bytes);
	PUT(worker_pid);
	PUT(loader_pid);
	PUT(device_bytes);
	PUT(device_losses);
	PUT(validation_errors);
	PUT(slice_ms);
	PUT(max_connections);
	PUT(max_scenes);
#undef PUT
	json_object_set_new(object, "device", cli_json_text(s->device));
	json_object_set_new(object, "device_error", cli_json_text(s->device_error));
	json_object_set_new(object, "device_note", cli_json_text(s->device_note));
	return object;
}

static enum exit_code ask_stats(const struct cli *cli, candil_client *client, const char *argument)
{
	struct candil_error error;
	struct candil_stats stats;
	(void)argument;
	candil_set_timeout(client, ANSWER_MS);
	if (candil_stats(client, &stats, &error) != CANDIL_STATUS_OK)
		return cli_fail(cli, &error, stdout);
	if (cli->json)
		return cli_print_json(stats_json(&stats), stdout, EXIT_DONE);
	print_stats(&stats);
	return cli_flush(stdout, EXIT_DONE);
}

static enum exit_code run_stats(struct cli *cli, const struct command *self, int argc, char **argv)
{
	return cli_ask(cli, self, argc, argv, 0, ask_stats);
}

const struct command stats_command = {
    .name = "stats",
    .summary = "what the daemon has done and holds",
    .help = "Usage: candil stats [--connect ADDR] [--json]\n\n"
	    "Prints the daemon's counters: jobs, scenes, memory, processes.\n\n"
	    "--json: {\"uptime_us\", \"connections\", \"jobs\", \"jobs_done\", \"jobs_failed\", \"jobs_cancelled\", "
	    "\"slices\",\n"
	    "\"worker_starts\", \"loader_starts\", \"loader_failures\", \"scenes\", \"scene_bytes\", \"buffered_bytes\",\n"
	    "\"image_bytes\", \"worker_pid\", \"loader_pid\", \"device_bytes\", \"validation_errors\", \"slice_ms\",\n"
	    "\"max_connections\", \"max_scenes\", \"device\", \"device_error\", \"device_losses\",\n"
	    "\"device_note\"}\n",
    .run = run_stats,
};
