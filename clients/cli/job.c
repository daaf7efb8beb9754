#include "clients/cli/job.h"

#include <errno.h>
#include <inttypes.h>

#include "clients/cli/interrupt.h"
#include "clients/libcandil/error.h"

void job_begin(struct job *job)
{
	job->output = job->options.output;
	progress_init(&job->progress, job->options.quiet);
	interrupt_begin();
}

void job_end(struct job *job)
{
	target_close(&job->target);
	interrupt_end();
}

enum exit_code job_fail(struct job *job, const struct candil_error *error)
{
	progress_clear(&job->progress);
	return cli_fail(job->cli, error, job->stream);
}

enum exit_code job_fail_output(struct job *job, const char *name)
{
	char what[256];
	const int failure = errno;
	if (failure == ECANCELED) {
		struct candil_error error;
		error_set(&error, CANDIL_STATUS_CANCELLED, "cancelled while %.150s was waited for", name);
		return job_fail(job, &error);
	}
	snprintf(what, sizeof(what), "cannot write %s", name);
	progress_clear(&job->progress);
	errno = failure;
	return cli_fail_errno(job->cli, what, job->stream);
}

enum exit_code job_fail_between(struct job *job)
{
	const struct candil_error error = {.code = CANDIL_STATUS_CANCELLED, .text = "cancelled between two requests"};
	return job_fail(job, &error);
}

enum exit_code job_open(struct job *job)
{
	struct candil_error error;
	if (job->target.client)
		return EXIT_DONE;
	progress_say(&job->progress, "loading the scene");
	candil_status status = target_open(&job->target, job->cli->address, job->options.scene, &job->options.load, &error);
	if (status == CANDIL_STATUS_OK)
		status = target_parts(&job->target, &job->options.request, &error);
	job->options.request.scene = job->target.scene;
	return status == CANDIL_STATUS_OK ? EXIT_DONE : job_fail(job, &error);
}

void job_take_accepted(struct job *job, const struct candil_accepted *accepted)
{
	if (job->is_accepted)
		return;
	job->is_accepted = true;
	job->accepted = *accepted;
	if (job->cli->json || accepted->warning_count == 0)
		return;
	progress_clear(&job->progress);
	for (uint32_t i = 0; i < accepted->warning_count; i++)
		fprintf(stderr, "warning    %s\n", accepted->warnings[i]);
	if (accepted->warnings_more > 0)
		fprintf(stderr, "warning    %" PRIu32 " more\n", accepted->warnings_more);
}

void job_put_warnings(const struct job *job, json_t *answer)
{
	json_t *warnings = json_array();
	for (uint32_t i = 0; i < job->accepted.warning_count; i++)
		json_array_append_new(warnings, cli_json_text(job->accepted.warnings[i]));
	json_object_set_new(answer, "warnings", warnings);
	json_object_set_new(answer, "warnings_more", cli_json_u64(job->accepted.warnings_more));
}

// See a request through to its end. *failure: errno of an output that could not be written, else 0.
static candil_status see_through(struct job *job, uint32_t id, bool (*take)(void *user, const struct candil_event *event),
				 void *user, int *failure, struct candil_error *error)
{
	candil_client *client = job->target.client;
	candil_status status = CANDIL_STATUS_OK;
	struct candil_event event = {0};
	*failure = 0;
	while (status == CANDIL_STATUS_OK && !event.ends_request) {
		if (!interrupt_wait(client, &event, &status, error)) {
			if (status == CANDIL_STATUS_OK)
				status = candil_cancel(client, id, error);
			continue;
		}
		if (event.id != id)
			continue;
		if (event.kind == CANDIL_EVENT_ERROR && !*failure) {
			*error = event.u.error;
			return error->code;
		}
		if (!*failure && !take(user, &event)) {
			// The request must still be seen through to its end: the connection takes no other call before, and
			// a scene that was loaded for this command has to be unloaded.
			*failure = errno ? errno : EIO;
			if (!event.ends_request)
				status = candil_cancel(client, id, error);
		}
	}
	return status;
}

candil_status job_await(struct job *job, uint32_t id, bool (*take)(void *user, const struct candil_event *event), void *user,
			struct candil_error *error)
{
	int failure;
	return see_through(job, id, take, user, &failure, error);
}

enum exit_code job_follow(struct job *job, uint32_t id, bool (*take)(void *user, const struct candil_event *event),
			  void *user)
{
	struct candil_error error;
	int failure;
	const candil_status status = see_through(job, id, take, user, &failure, &error);
	if (failure) {
		errno = failure;
		return job_fail_output(job, job->output);
	}
	return status == CANDIL_STATUS_OK ? EXIT_DONE : job_fail(job, &error);
}
