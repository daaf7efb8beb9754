// sweep: pictures of one scene from many cameras, each in a file of its own.
//
// A run that was cut short is simply started again: what it finished is on disk under its final name, whole (output.h), is
// recognised as such (verify.h) and left alone.
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/interrupt.h"
#include "clients/cli/output.h"
#include "clients/cli/progress.h"
#include "clients/cli/render_options.h"
#include "clients/cli/sweep_cameras.h"
#include "clients/cli/target.h"
#include "clients/cli/verify.h"
#include "clients/cli/view.h"

struct picture {
	uint32_t index;
	char *name;
	bool there; // whole, under its name
	bool written; // by this call
};

struct sweep {
	const struct cli *cli;
	struct render_options options;
	struct sweep_texts texts;
	struct target target;
	struct progress progress;
	struct candil_camera *cameras; // all; with --orbit not before the scene is known
	uint32_t count;
	double elevation, radius;
	uint32_t shard, shards; // this one, from 1
	struct picture *pictures; // of this shard
	uint32_t picture_count, written, skipped;
	struct picture *batch[CANDIL_SWEEP_CAMERAS]; // of the request that is under way
	uint32_t batch_count, retries;
	uint64_t rays, elapsed_us;
	char device[128];
};

static enum exit_code fail(struct sweep *sweep, const struct candil_error *error)
{
	progress_clear(&sweep->progress);
	return cli_fail(sweep->cli, error, stdout);
}

static enum exit_code fail_output(struct sweep *sweep, const char *name)
{
	char what[256];
	snprintf(what, sizeof(what), "cannot write %s", name);
	progress_clear(&sweep->progress);
	return cli_fail_errno(sweep->cli, what, stdout);
}

// ---- before the scene ------------------------------------------------------------------------------------------------

// The sentence that says what does not fit together, or NULL.
static const char *settle_texts(struct sweep *sweep)
{
	const struct sweep_texts *t = &sweep->texts;
	sweep->shard = sweep->shards = 1;
	if (!t->orbit == !t->cameras)
		return "--orbit or --cameras is needed, and not both";
	if (!strstr(sweep->options.output, "{index}"))
		return "the output's name must have {index} in it: each image is a file of its own";
	if (t->orbit && !sweep_orbit_parse(t->orbit, &sweep->count, &sweep->elevation, &sweep->radius))
		return "--orbit is N[,DEGREES[,METRES]]: 1 to 1000000 cameras, within 89 degrees, above 0 metres";
	if (t->shard && !sweep_shard_parse(t->shard, &sweep->shard, &sweep->shards))
		return "--shard is I/N, I from 1 to N";
	return NULL;
}

// Name this shard's images and see which of them are there.
static bool list_pictures(struct sweep *sweep)
{
	const struct candil_render_request *r = &sweep->options.request;
	sweep->pictures = calloc((size_t)sweep->count / sweep->shards + 1, sizeof(*sweep->pictures));
	if (!sweep->pictures)
		return false;
	for (uint64_t i = sweep->shard - 1; i < sweep->count; i += sweep->shards) {
		struct picture *p = &sweep->pictures[sweep->picture_count++];
		p->index = (uint32_t)i;
		p->name = sweep_name(sweep->options.output, p->index, sweep->count);
		if (!p->name)
			return false;
		p->there = !sweep->texts.force && verify_image(p->name, r->format == CANDIL_FORMAT_PNG, r->width, r->height);
		sweep->skipped += p->there;
	}
	return true;
}

// Before anything is computed: whether the first image that is due could be written.
static enum exit_code probe_output(struct sweep *sweep)
{
	for (uint32_t i = 0; i < sweep->picture_count; i++) {
		struct output output;
		if (sweep->pictures[i].there)
			continue;
		bool good = output_open(&output, sweep->pictures[i].name);
		int failure = errno;
		output_close(&output);
		errno = failure;
		return good ? EXIT_DONE : fail_output(sweep, sweep->pictures[i].name);
	}
	return EXIT_DONE;
}

// ---- rendering -------------------------------------------------------------------------------------------------------

static bool make_orbit(struct sweep *sweep)
{
	sweep->cameras = calloc(sweep->count, sizeof(*sweep->cameras));
	for (uint32_t i = 0; sweep->cameras && i < sweep->count; i++)
		view_orbit(&sweep->target.info, &sweep->options.request, i, sweep->count, sweep->elevation, sweep->radius,
			   &sweep->cameras[i]);
	return sweep->cameras != NULL;
}

static void draw_progress(struct sweep *sweep, double fraction)
{
	double due = (double)(sweep->picture_count - sweep->skipped);
	double before = (double)sweep->written;
	progress_images(&sweep->progress, due > 0 ? (before + fraction) / due : 1.0, sweep->skipped + sweep->written,
			sweep->picture_count);
}

static bool write_image(struct sweep *sweep, const struct candil_image *image)
{
	struct picture *p = sweep->batch[image->index];
	struct output output;
	bool good = output_open(&output, p->name) && output_write(&output, image->data, image->bytes);
	int failure = errno;
	output_close(&output);
	errno = failure;
	p->there = p->there || good;
	p->written = good;
	sweep->written += good;
	return good;
}

// One event of a request. false: an image cannot be written (errno).
static bool take_event(struct sweep *sweep, const struct candil_event *event, uint32_t written_before)
{
	switch (event->kind) {
	case CANDIL_EVENT_PROGRESS: {
		// Of the images in this request; those that are written count already.
		double done = event->u.progress.fraction * sweep->batch_count - (sweep->written - written_before);
		draw_progress(sweep, done > 0 ? done : 0);
		return true;
	}
	case CANDIL_EVENT_IMAGE:
		if (!write_image(sweep, &event->u.image))
			return false;
		draw_progress(sweep, 0);
		return true;
	case CANDIL_EVENT_DONE:
		sweep->rays += event->u.done.rays;
		sweep->retries += event->u.done.retries;
		sweep->elapsed_us += event->u.done.elapsed_us;
		memcpy(sweep->device, event->u.done.device, sizeof(sweep->device));
		return true;
	default:
		return true;
	}
}

// Take the next pictures that are due, as many as one request bears. false: none is left.
static bool next_batch(struct sweep *sweep, uint32_t *at, struct candil_camera *cameras)
{
	const struct candil_render_request *r = &sweep->options.request;
	uint64_t one = (uint64_t)r->width * r->height * r->samples;
	uint64_t most = one > 0 ? candil_server(sweep->target.client)->max_samples_times_pixels / one : 1;
	if (most > CANDIL_SWEEP_CAMERAS)
		most = CANDIL_SWEEP_CAMERAS;
	if (most == 0)
		most = 1; // the daemon says what is wrong
	sweep->batch_count = 0;
	for (; *at < sweep->picture_count && sweep->batch_count < most; ++*at) {
		struct picture *p = &sweep->pictures[*at];
		if (p->there)
			continue;
		cameras[sweep->batch_count] = sweep->cameras[p->index];
		sweep->batch[sweep->batch_count++] = p;
	}
	return sweep->batch_count > 0;
}

// Submit a request and see it through, as render does.
static enum exit_code see_through(struct sweep *sweep, const struct candil_camera *cameras)
{
	candil_client *client = sweep->target.client;
	struct candil_error error;
	struct candil_event event = {0};
	const uint32_t before = sweep->written;
	int failure = 0; // of an output: errno
	uint32_t id, bad = 0;
	candil_status status =
	    candil_submit_sweep(client, &sweep->options.request, cameras, sweep->batch_count, &id, &error);
	while (status == CANDIL_STATUS_OK && !event.ends_request) {
		if (!interrupt_wait(client, &event, &status, &error)) {
			if (status == CANDIL_STATUS_OK)
				status = candil_cancel(client, id, &error);
			continue;
		}
		if (event.id != id)
			continue;
		if (event.kind == CANDIL_EVENT_ERROR && !failure)
			return fail(sweep, &event.u.error);
		if (!failure && !take_event(sweep, &event, before)) {
			failure = errno ? errno : EIO;
			bad = event.u.image.index;
			if (!event.ends_request)
				status = candil_cancel(client, id, &error);
		}
	}
	if (failure) {
		errno = failure;
		return fail_output(sweep, sweep->batch[bad]->name);
	}
	return status == CANDIL_STATUS_OK ? EXIT_DONE : fail(sweep, &error);
}

static enum exit_code render_pictures(struct sweep *sweep)
{
	static struct candil_camera cameras[CANDIL_SWEEP_CAMERAS];
	struct candil_error error;
	uint32_t at = 0;
	enum exit_code code = EXIT_DONE;
	progress_say(&sweep->progress, "loading the scene");
	candil_status status =
	    target_open(&sweep->target, sweep->cli->address, sweep->options.scene, &sweep->options.load, &error);
	if (status != CANDIL_STATUS_OK)
		return fail(sweep, &error);
	sweep->options.request.scene = sweep->target.scene;
	if (sweep->texts.orbit && !make_orbit(sweep)) {
		errno = ENOMEM;
		return cli_fail_errno(sweep->cli, "the orbit", stdout);
	}
	draw_progress(sweep, 0);
	while (code == EXIT_DONE && next_batch(sweep, &at, cameras)) {
		code = see_through(sweep, cameras);
		if (code == EXIT_DONE && interrupt_seen() && at < sweep->picture_count) {
			error =
			    (struct candil_error){.code = CANDIL_STATUS_CANCELLED, .text = "cancelled between two requests"};
			code = fail(sweep, &error);
		}
	}
	return code;
}

// ---- the summary -----------------------------------------------------------------------------------------------------

static json_t *picture_json(const struct sweep *sweep, const struct picture *p)
{
	json_t *o = json_pack("{s:o,s:o,s:s}", "index", cli_json_u64(p->index), "image", cli_json_text(p->name), "state",
			      p->written ? "written" : "skipped");
	const struct candil_camera *c = sweep->cameras ? &sweep->cameras[p->index] : NULL;
	if (o && c)
		json_object_set_new(o, "camera",
				    json_pack("{s:o,s:o,s:o,s:f}", "eye", cli_json_vec3(&c->eye), "target",
					      cli_json_vec3(&c->target), "up", cli_json_vec3(&c->up), "vfov_degrees",
					      c->vfov_degrees));
	return o;
}

static json_t *summary_json(const struct sweep *sweep)
{
	const struct candil_render_request *r = &sweep->options.request;
	json_t *images = json_array();
	for (uint32_t i = 0; i < sweep->picture_count; i++)
		json_array_append_new(images, picture_json(sweep, &sweep->pictures[i]));
	return json_pack("{s:o,s:o,s:s,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "output",
			 cli_json_text(sweep->options.output), "scene", cli_json_text(sweep->options.scene), "format",
			 candil_format_name(r->format), "width", cli_json_u64(r->width), "height", cli_json_u64(r->height),
			 "samples", cli_json_u64(r->samples), "cameras", cli_json_u64(sweep->count), "shard",
			 cli_json_u64(sweep->shard), "shards", cli_json_u64(sweep->shards), "written",
			 cli_json_u64(sweep->written), "skipped", cli_json_u64(sweep->skipped), "elapsed_us",
			 cli_json_u64(sweep->elapsed_us), "rays", cli_json_u64(sweep->rays), "retries",
			 cli_json_u64(sweep->retries), "images", images);
}

static enum exit_code say_summary(struct sweep *sweep)
{
	progress_clear(&sweep->progress);
	if (sweep->cli->json)
		return cli_print_json(summary_json(sweep), stdout, EXIT_DONE);
	if (sweep->options.quiet)
		return EXIT_DONE;
	printf("images     %u of %u cameras: %u written, %u there already\n", sweep->picture_count, sweep->count,
	       sweep->written, sweep->skipped);
	if (sweep->written > 0)
		printf("time       %.1f ms, %.1f ms an image, on %s\n", (double)sweep->elapsed_us * 1e-3,
		       (double)sweep->elapsed_us * 1e-3 / sweep->written, sweep->device);
	if (sweep->retries > 0)
		printf("retries    %u: the worker was lost and an image begun again\n", sweep->retries);
	return cli_flush(stdout, EXIT_DONE);
}

// ---- the command -----------------------------------------------------------------------------------------------------

static enum exit_code do_sweep(struct sweep *sweep)
{
	struct candil_error error = {0};
	if (sweep->texts.cameras && !sweep_cameras_read(sweep->texts.cameras, &sweep->cameras, &sweep->count, &error))
		return fail(sweep, &error);
	if (!list_pictures(sweep)) {
		errno = ENOMEM;
		return cli_fail_errno(sweep->cli, "the list of images", stdout);
	}
	enum exit_code code = probe_output(sweep);
	// With nothing left to do, neither a daemon nor the scene is asked for.
	if (code == EXIT_DONE && sweep->skipped < sweep->picture_count)
		code = render_pictures(sweep);
	return code == EXIT_DONE ? say_summary(sweep) : code;
}

static enum exit_code run_sweep(struct cli *cli, const struct command *self, int argc, char **argv)
{
	// Large, and not needed twice.
	static struct sweep sweep;
	enum exit_code code = EXIT_DONE;
	memset(&sweep, 0, sizeof(sweep));
	sweep.cli = cli;
	if (!sweep_options_parse(cli, self, argc, argv, &sweep.options, &sweep.texts, &code))
		return code;
	const char *wrong = settle_texts(&sweep);
	if (wrong)
		return cli_usage(self, "%s", wrong);
	progress_init(&sweep.progress, sweep.options.quiet);
	interrupt_begin();
	code = do_sweep(&sweep);
	target_close(&sweep.target);
	interrupt_end();
	for (uint32_t i = 0; i < sweep.picture_count; i++)
		free(sweep.pictures[i].name);
	free(sweep.pictures);
	free(sweep.cameras);
	return code;
}

const struct command sweep_command = {
    .name = "sweep",
    .summary = "make pictures of a scene from many cameras",
    .help =
	"Usage: candil sweep SCENE -o 'OUT.{index}.exr' (--orbit N[,DEGREES[,METRES]] | --cameras FILE) [options]\n\n"
	"One image a camera. {index} in the output's name is the camera's number, from 0, with zeros before it to the\n"
	"width of the number of cameras.\n\n"
	"  --orbit N[,DEGREES[,METRES]]\n"
	"                        N cameras on a circle about the middle of the scene's bounds, +Y up, the first in front\n"
	"                        (+Z); DEGREES above the horizon, default 20; METRES from the middle, default: so far\n"
	"                        that the whole scene is in view\n"
	"  --cameras FILE        a JSON array of cameras, or one after the other (JSON lines); each an array of ten\n"
	"                        numbers as in render's --camera, or {\"eye\": [x,y,z], \"target\": [x,y,z],\n"
	"                        \"up\": [x,y,z], \"vfov\": degrees}, where up may be left out (+Y)\n"
	"  --shard I/N           of N calls that share the work this is number I, from 1: cameras I-1, I-1+N, …\n"
	"  --force               render images that are there already\n\n"
	"and the options of candil render but --camera and --progressive. Animations of a file are not read.\n\n"
	"An image appears under its name whole or not at all. One that is there, whole and of the size asked for, is\n"
	"left alone: start a sweep that was cut short again, and it goes on. Whole is a PNG whose chunks lead to IEND at\n"
	"its end, and an EXR whose offset table is filled and whose blocks end where the file ends. What the image\n"
	"shows is not looked at: with another scene, cameras or samples use another name, or --force.\n\n"
	"--json: {\"output\", \"scene\", \"format\", \"width\", \"height\", \"samples\", \"cameras\", \"shard\", "
	"\"shards\",\n"
	"\"written\", \"skipped\", \"elapsed_us\", \"rays\", \"retries\", \"images\": [{\"index\", \"image\",\n"
	"\"state\": \"written\"|\"skipped\", \"camera\" (absent: an orbit of which nothing was rendered)}]}\n"
	"Exit codes: 0 every image of the call is there; others as in candil --help. Images already written stay.\n",
    .run = run_sweep,
};
