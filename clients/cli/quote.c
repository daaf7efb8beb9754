// quote: what a picture would take and how good it would be.
#include "clients/cli/quote.h"

#include <inttypes.h>
#include <string.h>

#include "clients/cli/job.h"
#include "clients/cli/view.h"

static void put_known(json_t *object, const char *key, double value)
{
	json_object_set_new(object, key, value >= 0 ? json_real(value) : json_null());
}

static void put_choice(json_t *o, const struct candil_choice *c)
{
	json_object_set_new(o, "technique", json_string(candil_technique_name(c->technique)));
	json_object_set_new(o, "settings", json_pack("{s:o}", "samples", cli_json_u64(c->samples)));
	put_known(o, "time_ms", c->time_ms);
	put_known(o, "time_ms_low", c->time_ms_low);
	put_known(o, "time_ms_high", c->time_ms_high);
	put_known(o, "relmse", c->relmse);
	put_known(o, "relmse_low", c->relmse_low);
	put_known(o, "relmse_high", c->relmse_high);
}

static json_t *other_json(bool has, const struct candil_choice *choice)
{
	json_t *o = has ? json_object() : json_null();
	if (has)
		put_choice(o, choice);
	return o;
}

json_t *quote_json(const struct candil_quote *q)
{
	json_t *o = json_object(), *notes = json_array();
	put_choice(o, &q->choice);
	json_object_set_new(o, "met", json_boolean(q->met));
	json_object_set_new(o, "why", cli_json_text(q->why));
	json_object_set_new(o, "cheaper", other_json(q->has_cheaper, &q->cheaper));
	json_object_set_new(o, "better", other_json(q->has_better, &q->better));
	json_object_set_new(o, "from", cli_json_text(q->from));
	put_known(o, "cold_ms", q->cold_ms);
	put_known(o, "queue_ms", q->queue_ms);
	json_object_set_new(o, "jobs", cli_json_u64(q->jobs));
	json_object_set_new(o, "records", cli_json_u64(q->records));
	for (uint32_t i = 0; i < q->note_count; i++)
		json_array_append_new(notes, cli_json_text(q->notes[i]));
	json_object_set_new(o, "notes", notes);
	return o;
}

static void print_choice(const char *title, const struct candil_choice *c)
{
	printf("%-10s %s, %" PRIu32 " sample%s", title, candil_technique_name(c->technique), c->samples, cli_s(c->samples));
	printf(": %.1f ms (%.1f … %.1f), relative MSE ", c->time_ms, c->time_ms_low, c->time_ms_high);
	if (c->relmse >= 0)
		printf("%.2e (%.2e … %.2e)\n", c->relmse, c->relmse_low, c->relmse_high);
	else
		puts("unknown");
}

static void print_quote(const struct candil_quote *q)
{
	print_choice("quote", &q->choice);
	printf("why        %s\n", q->why);
	if (q->has_cheaper)
		print_choice("cheaper", &q->cheaper);
	if (q->has_better)
		print_choice("better", &q->better);
	printf("from       %s, %" PRIu32
	       " record%s of this scene; nine times of ten what comes out lies between the two ends\n",
	       q->from, q->records, cli_s(q->records));
	for (uint32_t i = 0; i < q->note_count; i++)
		printf("note       %s\n", q->notes[i]);
}

struct asked {
	struct job job;
	struct candil_quote quote;
};

static bool take_answer(void *user, const struct candil_event *event)
{
	struct asked *asked = user;
	if (event->kind == CANDIL_EVENT_QUOTE)
		asked->quote = event->u.quote;
	return true;
}

static enum exit_code ask(struct asked *asked)
{
	struct job *job = &asked->job;
	struct candil_render_request *request = &job->options.request;
	struct candil_error error;
	uint32_t id;
	enum exit_code code = job_open(job);
	if (code != EXIT_DONE)
		return code;
	if (!request->has_camera && !request->camera_name && job->target.info.camera_count == 0)
		view_frame_bounds(&job->target.info, request);
	progress_say(&job->progress, "asking for a quote");
	if (candil_submit_quote(job->target.client, request, job->options.pilot_ms, &id, &error) != CANDIL_STATUS_OK)
		return job_fail(job, &error);
	code = job_follow(job, id, take_answer, asked);
	if (code != EXIT_DONE)
		return code;
	progress_clear(&job->progress);
	job_end(job);
	if (job->cli->json)
		return cli_print_json(quote_json(&asked->quote), stdout, EXIT_DONE);
	print_quote(&asked->quote);
	return cli_flush(stdout, EXIT_DONE);
}

static enum exit_code run_quote(struct cli *cli, const struct command *self, int argc, char **argv)
{
	// Static because it is too large for the stack; a process runs one command.
	static struct asked asked;
	enum exit_code code = EXIT_DONE;
	memset(&asked, 0, sizeof(asked));
	asked.job.cli = cli;
	asked.job.stream = stdout;
	if (!quote_options_parse(cli, self, argc, argv, &asked.job.options, &code))
		return code;
	job_begin(&asked.job);
	code = ask(&asked);
	job_end(&asked.job);
	return code;
}

const struct command quote_command = {
    .name = "quote",
    .summary = "say what a picture would take, and how good it would be",
    .help =
	"Usage: candil quote SCENE (--time MS | --error E) [--technique NAME] [--pilot MS] [render's options]\n\n"
	"Answers before anything is rendered: the technique and samples with the least error within MS, or the least time\n"
	"within E (a relative MSE); the time and the error to expect, each with an interval that holds nine times of ten;\n"
	"the next cheaper and the next better choice. With neither, what exactly this render would take. SCENE and all\n"
	"options are those of candil render; of -o the format alone counts.\n\n"
	"What frames of this scene have told is known already. A view that is not known is looked at first, by a small\n"
	"picture of {noise}, for less than 0.3 s of device time. The answer is there within a second once SCENE is\n"
	"loaded, whatever the device is doing, if need be from less and with a wider interval; with --pilot it is waited "
	"for.\n"
	"\n"
	"  --time MS             the least error within so many milliseconds, from the request to the image\n"
	"  --error E             the least time within this relative MSE\n"
	"  --technique NAME      this one alone: {techniques}; default: whichever is the best\n"
	"  --pilot MS            let a look take so long, by every technique, programs compiled and voxels made beside: it\n"
	"                        tells how far techniques without noise are off, and takes as long as it takes\n\n"
	"Times are those of an idle device with its programs compiled. What compiling takes the first time, and what other\n"
	"jobs add, is told apart.\n\n"
	"--json: " QUOTE_JSON_HELP
	"Exit codes: 0 an answer is printed, also if nothing meets what is asked (\"met\"); others as in candil --help.\n",
    .run = run_quote,
};
