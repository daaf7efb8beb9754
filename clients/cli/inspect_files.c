#include "clients/cli/inspect_files.h"

#include <errno.h>
#include <string.h>

#include "clients/cli/interrupt.h"
#include "clients/cli/output.h"

size_t inspect_settings(const struct inspect *inspect, const char *show, struct candil_option *options)
{
	const struct candil_render_request *r = &inspect->job.options.request;
	const bool row = strcmp(show, INSPECT_SHOW_ROW) == 0;
	size_t count = 0;
	for (size_t i = 0; i < r->option_count; i++)
		if (row || strcmp(r->options[i].name, inspect->row) != 0)
			options[count++] = r->options[i];
	return count;
}

// Take one event of the file that is under way. false: it cannot be written, errno says why.
static bool take_file_event(void *user, const struct candil_event *event)
{
	struct inspect *inspect = user;
	struct inspect_file *f = &inspect->files[inspect->file];
	if (event->kind == CANDIL_EVENT_PROGRESS)
		progress_draw(&inspect->job.progress, &event->u.progress);
	if (event->kind == CANDIL_EVENT_DONE)
		f->done = event->u.done;
	if (event->kind != CANDIL_EVENT_IMAGE)
		return true;
	f->bytes = event->u.image.bytes;
	f->failure = output_save(f->name, event->u.image.data, event->u.image.bytes) ? 0 : errno;
	errno = f->failure;
	return f->failure == 0;
}

// Make one. One that would be too large is told in the answer, and is no reason to do without what else there is.
static enum exit_code make_file(struct inspect *inspect, enum candil_format format)
{
	struct inspect_file *f = &inspect->files[inspect->file];
	struct candil_render_request request = inspect->job.options.request;
	struct candil_option options[INSPECT_SETTINGS];
	uint32_t id;
	request.option_count = inspect_settings(inspect, "", options);
	request.options = options;
	request.format = format;
	request.aovs = request.deadline_ms = 0;
	candil_status status = candil_submit_render(inspect->job.target.client, &request, &id, &f->error);
	if (status == CANDIL_STATUS_OK)
		status = job_await(&inspect->job, id, take_file_event, inspect, &f->error);
	errno = f->failure;
	if (f->failure)
		return job_fail_output(&inspect->job, f->name);
	return status == CANDIL_STATUS_OK || status == CANDIL_STATUS_LIMIT ? EXIT_DONE : job_fail(&inspect->job, &f->error);
}

enum exit_code inspect_make_files(struct inspect *inspect)
{
	static const enum candil_format formats[FILES] = {CANDIL_FORMAT_PLY, CANDIL_FORMAT_MTX};
	enum exit_code code = EXIT_DONE;
	for (; code == EXIT_DONE && inspect->file < inspect_file_count(inspect); inspect->file++)
		code = interrupt_seen() ? job_fail_between(&inspect->job) : make_file(inspect, formats[inspect->file]);
	return code;
}

enum exit_code inspect_files_exit_code(const struct inspect *inspect)
{
	for (uint32_t i = 0; i < FILES; i++)
		if (inspect->files[i].error.code != CANDIL_STATUS_OK)
			return cli_exit_code(inspect->files[i].error.code);
	return EXIT_DONE;
}
