// sweep: pictures of one scene from many cameras, or at many times of an animation, each in a file of its own.
//
// A run that was cut short can simply be started again. An image that it finished is on disk, whole, under its final name
// (output.h); it is recognised as whole (verify.h) and as what would be made now (sweep_compare.h), and left alone.
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/cli/interrupt.h"
#include "clients/cli/job.h"
#include "clients/cli/output.h"
#include "clients/cli/report.h"
#include "clients/cli/sweep_cameras.h"
#include "clients/cli/sweep_compare.h"
#include "clients/cli/sweep_keys.h"
#include "clients/cli/view.h"
#include "protocol/names.h"
#include "protocol/text.h"

struct picture {
	uint32_t index;
	char *name;
	bool there; // the file is whole, and what this call would write
	bool written; // by this call
	const char *why; // a file was there and is written anew; NULL: none was, or --force
	struct candil_verdict verdict; // where this call wrote it
};

#define NOTES_MAX 8u // more sentences than that nobody reads

#define REASONS_MAX 32u // sweep_compare has fewer

// How many pictures are redone for a reason.
struct reason {
	const char *why;
	uint32_t count;
};

struct sweep {
	struct job job;
	struct sweep_texts texts;
	struct candil_camera *cameras; // all of them; NULL before the scene is known, if they depend on it
	uint32_t count; // of all cameras; 0 before the scene is known, if an animation by --fps decides
	double elevation, radius;
	const char *animation; // NULL: none
	double fps;
	uint32_t shard, shards; // this one, from 1, and how many there are
	struct picture *pictures; // of this shard
	uint32_t picture_count, written, skipped, redone;
	struct reason reasons[REASONS_MAX];
	uint32_t reason_count;
	struct picture *batch[CANDIL_SWEEP_CAMERAS]; // of the request that is under way
	uint32_t batch_count, written_before; // pictures of the request; `written` when it was submitted
	uint32_t requests, retries; // of those that are done
	bool late; // an image ended at its deadline
	uint64_t rays, elapsed_us, cold_us;
	struct candil_done error; // its relMSE alone: sums over the images that were written, negative where unknown
	char device[128];
	bool default_light; // what was rendered got it
	char notes[NOTES_MAX][192]; // of all requests, each kind once
	uint32_t note_count;
};

// ---- before the scene ------------------------------------------------------------------------------------------------

// Check which options say how many images there are, and from where.
static const char *settle_source(struct sweep *sweep)
{
	const struct sweep_texts *t = &sweep->texts;
	const int sources = (t->orbit != NULL) + (t->cameras != NULL) + (t->keys != NULL);
	if (sources > 1 || (sources == 0 && !sweep->animation))
		return "one of --orbit, --cameras and --keys is needed, or --animation alone or with one of them";
	const struct candil_render_request *r = &sweep->job.options.request;
	if (sources > 0 && (r->has_camera || r->camera_name))
		return "--camera is for --animation alone: the cameras are said";
	if (t->frames && sources > 0 && !t->keys)
		return "--frames is for --keys and --animation: --orbit and --cameras say how many there are";
	if (t->keys && !t->frames)
		return "--keys needs --frames N";
	return t->fps && (sources > 0 || t->frames) ? "--fps is for --animation alone, without --frames" : NULL;
}

// Parse the texts. Returns the sentence that says what does not fit together, or NULL.
static const char *settle_texts(struct sweep *sweep)
{
	static char unknown[256];
	const struct sweep_texts *t = &sweep->texts;
	sweep->shard = sweep->shards = 1;
	sweep->animation = sweep->job.options.edits.edits.animation;
	sweep->fps = SWEEP_FPS_DEFAULT;
	const char *wrong = settle_source(sweep);
	if (wrong)
		return wrong;
	if (!strstr(sweep->job.options.output, "{index}"))
		return "the output's name must have {index} in it: each image is a file of its own";
	if (sweep_name_unknown(sweep->job.options.output, unknown, sizeof(unknown)))
		return unknown;
	if (t->orbit && !sweep_orbit_parse(t->orbit, &sweep->count, &sweep->elevation, &sweep->radius))
		return "--orbit is N[,DEGREES[,METRES]]: 1 to 1000000 cameras, within 89 degrees, above 0 metres";
	if (t->frames && (!cli_parse_u32(t->frames, &sweep->count) || sweep->count < 1 || sweep->count > SWEEP_CAMERAS_MAX))
		return "--frames is a whole number from 1 to 1000000";
	if (t->fps && (!cli_parse_double(t->fps, &sweep->fps) || !(sweep->fps > 0) || sweep->fps > 1e6))
		return "--fps is a number above 0";
	if (t->shard && !sweep_shard_parse(t->shard, &sweep->shard, &sweep->shards))
		return "--shard is I/N, I from 1 to N";
	return NULL;
}

// Name the images of this shard. false: no memory.
static bool list_pictures(struct sweep *sweep)
{
	sweep->pictures = calloc((size_t)sweep->count / sweep->shards + 1, sizeof(*sweep->pictures));
	if (!sweep->pictures)
		return false;
	for (uint64_t i = sweep->shard - 1; i < sweep->count; i += sweep->shards) {
		struct picture *p = &sweep->pictures[sweep->picture_count++];
		p->index = (uint32_t)i;
		p->name = sweep_name(sweep->job.options.output, p->index, sweep->count);
		if (!p->name)
			return false;
	}
	return true;
}

static bool is_file_there(const struct sweep *sweep, const struct picture *p)
{
	return !sweep->texts.force && access(p->name, F_OK) == 0;
}

static void count_reason(struct sweep *sweep, const char *why)
{
	uint32_t i = 0;
	while (i < sweep->reason_count && strcmp(sweep->reasons[i].why, why) != 0)
		i++;
	sweep->redone++;
	if (i == REASONS_MAX)
		return;
	sweep->reasons[i].why = why;
	sweep->reasons[i].count++;
	sweep->reason_count += i == sweep->reason_count;
}

// Look which pictures are there already, once the cameras are known.
static void compare_pictures(struct sweep *sweep)
{
	for (uint32_t i = 0; i < sweep->picture_count; i++) {
		struct picture *p = &sweep->pictures[i];
		if (!is_file_there(sweep, p))
			continue;
		p->why = sweep_compare(p->name, &sweep->job.target, &sweep->job.options.request, &sweep->cameras[p->index]);
		p->there = !p->why;
		sweep->skipped += p->there;
		if (p->why)
			count_reason(sweep, p->why);
	}
}

// Find out before anything is computed whether the first image that is due can be written. Before compare_pictures that is
// the first that does not exist.
static enum exit_code sweep_probe_output(struct sweep *sweep, bool compared)
{
	for (uint32_t i = 0; i < sweep->picture_count; i++) {
		const struct picture *p = &sweep->pictures[i];
		if (compared ? p->there : is_file_there(sweep, p))
			continue;
		return output_probe(p->name) ? EXIT_DONE : job_fail_output(&sweep->job, p->name);
	}
	return EXIT_DONE;
}

// ---- rendering -------------------------------------------------------------------------------------------------------

static enum exit_code length_of(struct sweep *sweep, double *seconds)
{
	struct candil_error error = {.code = CANDIL_STATUS_BAD_ARGUMENT};
	enum exit_code code = job_open(&sweep->job);
	if (code != EXIT_DONE || sweep_animation_length(&sweep->job.target.info, sweep->animation, seconds))
		return code;
	snprintf(error.text, sizeof(error.text), "the scene has no animation '%.100s': candil describe lists them",
		 sweep->animation);
	return job_fail(&sweep->job, &error);
}

// The one camera of all frames of an animation, chosen as `candil render` chooses it.
static struct candil_camera one_camera(struct sweep *sweep)
{
	struct candil_render_request *r = &sweep->job.options.request;
	if (!r->has_camera && !r->camera_name && sweep->job.target.info.camera_count == 0)
		view_frame_bounds(&sweep->job.target.info, r);
	struct candil_camera camera = {.name = r->camera_name};
	if (r->has_camera)
		camera =
		    (struct candil_camera){.eye = r->eye, .target = r->target, .up = r->up, .vfov_degrees = r->vfov_degrees};
	return camera;
}

// Make the cameras that depend on the scene, and the times of all cameras.
static enum exit_code make_cameras(struct sweep *sweep)
{
	const bool known = sweep->cameras != NULL;
	double seconds = 0;
	enum exit_code code = sweep->animation ? length_of(sweep, &seconds) : EXIT_DONE;
	if (code != EXIT_DONE)
		return code;
	if (!known)
		sweep->cameras = calloc(sweep->count, sizeof(*sweep->cameras));
	if (!sweep->cameras) {
		errno = ENOMEM;
		return cli_fail_errno(sweep->job.cli, "the cameras", stdout);
	}
	const bool by_fps = sweep->animation && !sweep->texts.frames && !sweep->texts.orbit && !known;
	const struct candil_camera one = sweep->animation && !sweep->texts.orbit ? one_camera(sweep) : sweep->cameras[0];
	for (uint32_t i = 0; i < sweep->count; i++) {
		struct candil_camera *c = &sweep->cameras[i];
		if (sweep->texts.orbit)
			view_orbit(&sweep->job.target.info, &sweep->job.options.request, i, sweep->count, sweep->elevation,
				   sweep->radius, c);
		else if (!known)
			*c = one;
		c->time_s = by_fps ? i / sweep->fps : sweep->count > 1 ? seconds * i / (sweep->count - 1) : 0;
	}
	return EXIT_DONE;
}

static void sweep_draw_progress(struct sweep *sweep, double fraction)
{
	double due = (double)(sweep->picture_count - sweep->skipped);
	double before = (double)sweep->written;
	progress_images(&sweep->job.progress, due > 0 ? (before + fraction) / due : 1.0, sweep->skipped + sweep->written,
			sweep->picture_count);
}

static bool sweep_write_image(struct sweep *sweep, const struct candil_image *image)
{
	struct picture *p = sweep->batch[image->index];
	sweep->job.output = p->name;
	const bool good = output_save(p->name, image->data, image->bytes);
	p->there = p->there || good;
	p->written = good;
	p->verdict = image->verdict;
	sweep->written += good;
	return good;
}

// Add to a sum of numbers that are negative where they are not known.
static double add_known(double sum, double mean, uint32_t count)
{
	return sum < 0 || mean < 0 ? -1 : sum + mean * count;
}

static void add_error(struct sweep *sweep, const struct candil_done *done)
{
	struct candil_done *sum = &sweep->error;
	sum->error_kind = sweep->requests == 0
			      ? done->error_kind
			      : (enum candil_error_kind)error_kind_of_both(sum->error_kind, done->error_kind);
	sum->estimated_relmse = add_known(sum->estimated_relmse, done->estimated_relmse, sweep->batch_count);
	sum->relmse_low = add_known(sum->relmse_low, done->relmse_low, sweep->batch_count);
	sum->relmse_high = add_known(sum->relmse_high, done->relmse_high, sweep->batch_count);
}

static void sweep_add_notes(struct sweep *sweep, const char (*notes)[192], uint32_t count)
{
	for (uint32_t i = 0; i < count; i++) {
		uint32_t at = 0;
		while (at < sweep->note_count && !text_alike(sweep->notes[at], notes[i]))
			at++;
		if (at == sweep->note_count && at < NOTES_MAX)
			memcpy(sweep->notes[sweep->note_count++], notes[i], sizeof(notes[i]));
	}
}

// Take one event of a request. false: an image cannot be written, errno says why.
static bool sweep_take_event(void *user, const struct candil_event *event)
{
	struct sweep *sweep = user;
	switch (event->kind) {
	case CANDIL_EVENT_ACCEPTED:
		job_take_accepted(&sweep->job, &event->u.accepted);
		sweep->default_light |= event->u.accepted.default_light;
		sweep_add_notes(sweep, event->u.accepted.notes, event->u.accepted.note_count);
		return true;
	case CANDIL_EVENT_PROGRESS: {
		// The progress is over the images of this request. Those that are written are counted already.
		double done = event->u.progress.fraction * sweep->batch_count - (sweep->written - sweep->written_before);
		sweep_draw_progress(sweep, done > 0 ? done : 0);
		return true;
	}
	case CANDIL_EVENT_IMAGE:
		if (!sweep_write_image(sweep, &event->u.image))
			return false;
		sweep_draw_progress(sweep, 0);
		return true;
	case CANDIL_EVENT_DONE:
		add_error(sweep, &event->u.done);
		sweep->requests++;
		sweep->rays += event->u.done.rays;
		sweep->retries += event->u.done.retries;
		sweep->late |= strcmp(event->u.done.reason, "time") == 0;
		sweep->elapsed_us += event->u.done.elapsed_us;
		sweep->cold_us += event->u.done.cold_us;
		memcpy(sweep->device, event->u.done.device, sizeof(sweep->device));
		sweep_add_notes(sweep, event->u.done.notes, event->u.done.note_count);
		return true;
	default:
		return true;
	}
}

// Take the next pictures that are due, as many as one request can hold. false: none is left.
static bool next_batch(struct sweep *sweep, uint32_t *at, struct candil_camera *cameras)
{
	const struct candil_render_request *r = &sweep->job.options.request;
	uint64_t one = (uint64_t)r->width * r->height * r->samples;
	uint64_t most = one > 0 ? candil_server(sweep->job.target.client)->max_samples_times_pixels / one : 1;
	if (most > CANDIL_SWEEP_CAMERAS)
		most = CANDIL_SWEEP_CAMERAS;
	if (most == 0)
		most = 1; // too large for the daemon, which will say so
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

static enum exit_code sweep_see_through(struct sweep *sweep, const struct candil_camera *cameras)
{
	struct candil_error error;
	uint32_t id;
	sweep->written_before = sweep->written;
	if (candil_submit_sweep(sweep->job.target.client, &sweep->job.options.request, cameras, sweep->batch_count, &id,
				&error) != CANDIL_STATUS_OK)
		return job_fail(&sweep->job, &error);
	return job_follow(&sweep->job, id, sweep_take_event, sweep);
}

static enum exit_code render_pictures(struct sweep *sweep)
{
	static struct candil_camera cameras[CANDIL_SWEEP_CAMERAS];
	uint32_t at = 0;
	enum exit_code code = EXIT_DONE;
	sweep_draw_progress(sweep, 0);
	while (code == EXIT_DONE && next_batch(sweep, &at, cameras)) {
		code = sweep_see_through(sweep, cameras);
		if (code == EXIT_DONE && interrupt_seen() && at < sweep->picture_count)
			code = job_fail_between(&sweep->job);
	}
	return code;
}

// ---- the summary -----------------------------------------------------------------------------------------------------

static json_t *sweep_camera_json(const struct candil_camera *c)
{
	if (c->name)
		return json_pack("{s:o}", "name", cli_json_text(c->name));
	return json_pack("{s:o,s:o,s:o,s:f}", "eye", cli_json_vec3(&c->eye), "target", cli_json_vec3(&c->target), "up",
			 cli_json_vec3(&c->up), "vfov_degrees", c->vfov_degrees);
}

static json_t *sweep_picture_json(const struct sweep *sweep, const struct picture *p)
{
	json_t *o = json_pack("{s:o,s:o,s:s}", "index", cli_json_u64(p->index), "image", cli_json_text(p->name), "state",
			      p->written ? "written" : "skipped");
	const struct candil_camera *c = sweep->cameras ? &sweep->cameras[p->index] : NULL;
	if (o && c && (c->name || c->vfov_degrees > 0))
		json_object_set_new(o, "camera", sweep_camera_json(c));
	if (o && c && sweep->animation)
		json_object_set_new(o, "time_s", json_real(c->time_s));
	if (o && p->written)
		json_object_set_new(o, "verdict", report_verdict_json(&p->verdict));
	if (o && p->why)
		json_object_set_new(o, "why", json_string(p->why));
	return o;
}

static double mean_known(double sum, uint32_t count)
{
	return sum >= 0 && count > 0 ? sum / count : -1;
}

// The mean error of the images that were written.
static struct candil_done mean_error(const struct sweep *sweep)
{
	const struct candil_done *sum = &sweep->error;
	return (struct candil_done){.error_kind = sweep->written > 0 ? sum->error_kind : CANDIL_ERROR_KIND_UNKNOWN,
				    .estimated_relmse = mean_known(sum->estimated_relmse, sweep->written),
				    .relmse_low = mean_known(sum->relmse_low, sweep->written),
				    .relmse_high = mean_known(sum->relmse_high, sweep->written)};
}

static json_t *sweep_summary_json(const struct sweep *sweep)
{
	const struct candil_render_request *r = &sweep->job.options.request;
	json_t *images = json_array();
	for (uint32_t i = 0; i < sweep->picture_count; i++)
		json_array_append_new(images, sweep_picture_json(sweep, &sweep->pictures[i]));
	json_t *notes = json_array();
	for (uint32_t i = 0; i < sweep->note_count; i++)
		json_array_append_new(notes, cli_json_text(sweep->notes[i]));
	json_t *o = json_pack(
	    "{s:o,s:o,s:s,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:b,s:o,s:o}", "output",
	    cli_json_text(sweep->job.options.output), "scene", cli_json_text(sweep->job.options.scene), "format",
	    candil_format_name(r->format), "width", cli_json_u64(r->width), "height", cli_json_u64(r->height), "samples",
	    cli_json_u64(r->samples), "cameras", cli_json_u64(sweep->count), "shard", cli_json_u64(sweep->shard), "shards",
	    cli_json_u64(sweep->shards), "written", cli_json_u64(sweep->written), "skipped", cli_json_u64(sweep->skipped),
	    "redone", cli_json_u64(sweep->redone), "elapsed_us", cli_json_u64(sweep->elapsed_us), "cold_us",
	    cli_json_u64(sweep->cold_us), "rays", cli_json_u64(sweep->rays), "retries", cli_json_u64(sweep->retries),
	    "default_light", sweep->default_light, "notes", notes, "images", images);
	const struct candil_done mean = mean_error(sweep);
	if (o)
		report_put_error(o, &mean);
	return o;
}

// From these shares on a picture counts as black, clipped or missed as a whole.
#define WHOLE_BLACK 0.98
#define WHOLE_CLIPPED 0.5
#define WHOLE_MISSED 1.0

// How many of the pictures that were written are of no use; nothing if none is.
static void print_verdict(const struct sweep *sweep)
{
	uint32_t black = 0, clipped = 0, missed = 0;
	for (uint32_t i = 0; i < sweep->picture_count; i++) {
		const struct picture *p = &sweep->pictures[i];
		black += p->written && p->verdict.black >= WHOLE_BLACK;
		clipped += p->written && p->verdict.clipped >= WHOLE_CLIPPED;
		missed += p->written && p->verdict.missed >= WHOLE_MISSED;
	}
	if (black > 0)
		printf("verdict    %u of %u images are black\n", black, sweep->written);
	if (clipped > 0)
		printf("verdict    %u of %u images are mostly clipped\n", clipped, sweep->written);
	if (missed > 0)
		printf("verdict    %u of %u images see no surface\n", missed, sweep->written);
	for (uint32_t i = 0; i < sweep->note_count; i++)
		printf("note       %s\n", sweep->notes[i]);
}

static enum exit_code sweep_say_summary(struct sweep *sweep)
{
	const enum exit_code code = sweep->late ? EXIT_DEADLINE : EXIT_DONE;
	progress_clear(&sweep->job.progress);
	job_end(&sweep->job);
	if (sweep->job.cli->json) {
		json_t *answer = sweep_summary_json(sweep);
		job_put_warnings(&sweep->job, answer);
		return cli_print_json(answer, stdout, code);
	}
	if (sweep->job.options.quiet)
		return code;
	printf("images     %u of %u cameras: %u written, %u there already\n", sweep->picture_count, sweep->count,
	       sweep->written, sweep->skipped);
	if (sweep->redone > 0)
		printf("redone     %u that %s there and differed: ", sweep->redone, sweep->redone == 1 ? "was" : "were");
	for (uint32_t i = 0; i < sweep->reason_count; i++)
		printf("%s%s %u%s", i > 0 ? ", " : "", sweep->reasons[i].why, sweep->reasons[i].count,
		       i + 1 == sweep->reason_count ? "\n" : "");
	if (sweep->written > 0)
		printf("time       %.1f ms, %.1f ms an image, on %s\n", (double)sweep->elapsed_us * 1e-3,
		       (double)sweep->elapsed_us * 1e-3 / sweep->written, sweep->device);
	const struct candil_done mean = mean_error(sweep);
	if (sweep->written > 0)
		report_print_error(&mean, stdout);
	print_verdict(sweep);
	if (sweep->late)
		puts("ended      at the deadline, for at least one image");
	if (sweep->retries > 0)
		printf("retries    %u: the worker was lost and an image begun again\n", sweep->retries);
	return cli_flush(stdout, code);
}

// ---- the command -----------------------------------------------------------------------------------------------------

// Read the cameras of --cameras and --keys, and find out how many images there are.
static enum exit_code read_cameras(struct sweep *sweep)
{
	const char *path = sweep->texts.cameras ? sweep->texts.cameras : sweep->texts.keys;
	const char *option = sweep->texts.cameras ? "--cameras" : "--keys";
	struct candil_error error = {.code = CANDIL_STATUS_LIMIT};
	struct candil_camera *cameras;
	uint32_t count;
	if (path && !sweep_cameras_read(path, option, &cameras, &count, &error))
		return job_fail(&sweep->job, &error);
	if (sweep->texts.keys) {
		sweep->cameras = sweep_keys_spread(cameras, count, sweep->count);
		free(cameras);
		errno = ENOMEM;
		return sweep->cameras ? EXIT_DONE : cli_fail_errno(sweep->job.cli, "the frames", stdout);
	}
	if (path) {
		sweep->cameras = cameras;
		sweep->count = count;
	}
	double seconds;
	if (sweep->count > 0)
		return EXIT_DONE;
	enum exit_code code = length_of(sweep, &seconds);
	if (code != EXIT_DONE)
		return code;
	sweep->count = sweep_frames_of(seconds, sweep->fps);
	snprintf(error.text, sizeof(error.text), "the animation has more than %u frames: set --frames or a smaller --fps",
		 SWEEP_CAMERAS_MAX);
	return sweep->count > 0 ? EXIT_DONE : job_fail(&sweep->job, &error);
}

static enum exit_code do_sweep(struct sweep *sweep)
{
	enum exit_code code = read_cameras(sweep);
	if (code != EXIT_DONE)
		return code;
	if (!list_pictures(sweep)) {
		errno = ENOMEM;
		return cli_fail_errno(sweep->job.cli, "the list of images", stdout);
	}
	code = sweep_probe_output(sweep, false);
	if (code == EXIT_DONE)
		code = job_open(&sweep->job);
	if (code == EXIT_DONE)
		code = make_cameras(sweep);
	if (code == EXIT_DONE) {
		compare_pictures(sweep);
		code = sweep_probe_output(sweep, true);
	}
	if (code == EXIT_DONE)
		code = render_pictures(sweep);
	return code == EXIT_DONE ? sweep_say_summary(sweep) : code;
}

static enum exit_code run_sweep(struct cli *cli, const struct command *self, int argc, char **argv)
{
	// Static because it is too large for the stack; a process runs one command.
	static struct sweep sweep;
	enum exit_code code = EXIT_DONE;
	memset(&sweep, 0, sizeof(sweep));
	sweep.job.cli = cli;
	if (!sweep_options_parse(cli, self, argc, argv, &sweep.job.options, &sweep.texts, &code))
		return code;
	const char *wrong = settle_texts(&sweep);
	if (wrong)
		return cli_usage(self, "%s", wrong);
	sweep.job.stream = stdout;
	job_begin(&sweep.job);
	code = do_sweep(&sweep);
	job_end(&sweep.job);
	for (uint32_t i = 0; i < sweep.picture_count; i++)
		free(sweep.pictures[i].name);
	free(sweep.pictures);
	free(sweep.cameras);
	return code;
}

const struct command sweep_command = {
    .name = "sweep",
    .summary = "make pictures of a scene from many cameras, or of its animation",
    .help =
	"Usage: candil sweep SCENE -o 'OUT.{index}.exr' (--orbit N[,DEGREES[,METRES]] | --cameras FILE |\n"
	"                    --keys FILE --frames N | --animation NAME [--frames N | --fps F]) [options]\n\n"
	"One image a camera or frame. {index} in the output's name is its number, from 0, with zeros before it to the\n"
	"width of how many there are.\n\n"
	"  --orbit N[,DEGREES[,METRES]]\n"
	"                        N cameras on a circle about the middle of the scene's bounds, +Y up, the first in front\n"
	"                        (+Z); DEGREES above the horizon, default 20; METRES from the middle, default: so far\n"
	"                        that the whole scene is in view\n"
	"  --cameras FILE        a JSON array of cameras, or one after the other (JSON lines); each an array of ten\n"
	"                        numbers as in render's --camera, or {\"eye\": [x,y,z], \"target\": [x,y,z],\n"
	"                        \"up\": [x,y,z], \"vfov\": degrees}, where up may be left out (+Y)\n"
	"  --keys FILE           such cameras as keys: --frames N frames run smoothly through them (Catmull-Rom), the\n"
	"                        first and the last key being the first and the last frame\n"
	"  --animation NAME      the scene as that animation of the file has it, from its start to its end, both included:\n"
	"                        in --frames N, or --fps F a second (default 24); the camera is --camera, else the\n"
	"                        scene's first, and follows its node. With --orbit, --cameras or --keys its time runs\n"
	"                        evenly over those\n" EDIT_OPTIONS_HELP
	"  --shard I/N           of N calls that share the work this is number I, from 1: cameras I-1, I-1+N, …\n"
	"  --force               render images that are there already, whatever they are\n\n"
	"and the options of candil render but --at and --progressive.\n\n"
	"An image appears under its name whole or not at all. One that is there, whole and of the size asked for, is\n"
	"left alone if its metadata names this scene and this request: technique, camera, lens, samples, seed, end,\n"
	"options, effects, edits, background, default light, filter, AOVs, format and view. So start a sweep that was cut "
	"short again,\n"
	"and it goes on; change anything, and it makes anew what differs, and says what that was. Whole is a PNG whose\n"
	"chunks lead to IEND at its end, and an EXR whose offset table is filled and whose blocks end where the file\n"
	"ends. Pixels are not looked at, nor which device or version made them.\n\n"
	"--json: {\"output\", \"scene\", \"format\", \"width\", \"height\", \"samples\", \"cameras\", \"shard\", "
	"\"shards\",\n"
	"\"written\", \"skipped\", \"redone\" (of those written), \"error_kind\", \"estimated_relmse\", \"relmse_low\",\n"
	"\"relmse_high\" (means over those written, null: unknown), \"elapsed_us\",\n"
	"\"cold_us\" (of these: compiling), \"rays\", \"retries\",\n"
	"\"default_light\" (whether it was given), \"notes\": [], \"images\": [{\"index\", \"image\",\n"
	"\"state\": \"written\"|\"skipped\", \"camera\" (absent: the scene's first), \"time_s\" (of an animation),\n"
	"\"verdict\": {\"black\", \"clipped\", \"missed\"} (shares of the pixels, of one written),\n"
	"\"why\" (what differed in the image that was there)}], \"warnings\": [] (about the scene), \"warnings_more\"}\n"
	"Exit codes: 0 every image of the call is there; others as in candil --help. Images already written stay.\n",
    .run = run_sweep,
};
