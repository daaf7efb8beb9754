// inspect: the voxels of a scene as pictures and figures.
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/inspect_pictures.h"
#include "clients/cli/interrupt.h"
#include "clients/cli/job.h"
#include "clients/cli/output.h"
#include "clients/cli/report.h"
#include "clients/cli/view.h"
#include "protocol/limits.h"
#include "protocol/names.h"

// Options that a picture adds to those of --set.
enum { OWN_SHOW, OWN_LEVEL, OWN_AXIS, OWN_SLICE, OWN_OPTIONS };
static const char *const own_words[OWN_OPTIONS] = {"show", "level", "axis", "slice"};
#define MIB (1.0 / 1048576.0)

struct inspect {
	struct job job;
	struct inspect_list list;
	uint32_t done; // pictures that are written
	bool framed; // the scene has no camera
	char own[OWN_OPTIONS][LIMIT_OPTION_NAME + 1]; // names of the own options: the technique's name, a dot, a word
	char wrong[256]; // the sentence that says what inspect cannot take
};

static const char *extension(const struct inspect *inspect)
{
	return inspect->job.options.request.format == CANDIL_FORMAT_PNG ? "png" : "exr";
}

// ---- the pictures ----------------------------------------------------------------------------------------------------

static bool inspect_write_image(const struct inspect *inspect, struct inspect_picture *p, const struct candil_image *image)
{
	char name[PATH_MAX];
	if (!inspect_name(p, inspect->job.options.output, extension(inspect), name, sizeof(name))) {
		errno = ENAMETOOLONG;
		return false;
	}
	p->bytes = image->bytes;
	return output_save(name, image->data, image->bytes);
}

// Take one event of the picture that is under way. false: its file cannot be written, errno says why.
static bool inspect_take_event(void *user, const struct candil_event *event)
{
	struct inspect *inspect = user;
	struct inspect_picture *p = &inspect->list.pictures[inspect->done];
	switch (event->kind) {
	case CANDIL_EVENT_ACCEPTED:
		job_take_accepted(&inspect->job, &event->u.accepted);
		return true;
	case CANDIL_EVENT_PROGRESS:
		progress_images(&inspect->job.progress, (inspect->done + event->u.progress.fraction) / inspect->list.count,
				inspect->done, inspect->list.count);
		return true;
	case CANDIL_EVENT_IMAGE:
		return !event->u.image.final || inspect_write_image(inspect, p, &event->u.image);
	case CANDIL_EVENT_DONE:
		p->done = event->u.done;
		return true;
	default:
		return true;
	}
}

static enum exit_code inspect_see_through(struct inspect *inspect, const struct candil_render_request *request)
{
	struct candil_error error;
	uint32_t id;
	if (candil_submit_render(inspect->job.target.client, request, &id, &error) != CANDIL_STATUS_OK)
		return job_fail(&inspect->job, &error);
	return job_follow(&inspect->job, id, inspect_take_event, inspect);
}

// Make the next picture of the list.
static enum exit_code make_picture(struct inspect *inspect)
{
	const struct inspect_picture *p = &inspect->list.pictures[inspect->done];
	struct candil_render_request request = inspect->job.options.request;
	struct candil_option options[sizeof(inspect->job.options.settings) / sizeof(*inspect->job.options.settings)];
	char level[16], axis[] = "x", slice[16];
	size_t count = request.option_count;
	memcpy(options, inspect->job.options.settings, count * sizeof(*options));
	snprintf(level, sizeof(level), "%" PRIu32, p->level);
	snprintf(slice, sizeof(slice), "%" PRIu32, p->slice);
	axis[0] = "xyz"[p->axis];
	options[count++] = (struct candil_option){inspect->own[OWN_SHOW], p->show};
	options[count++] = (struct candil_option){inspect->own[OWN_LEVEL], level};
	if (p->slice != INSPECT_NO_SLICE) {
		options[count++] = (struct candil_option){inspect->own[OWN_AXIS], axis};
		options[count++] = (struct candil_option){inspect->own[OWN_SLICE], slice};
	}
	request.options = options;
	request.option_count = count;
	request.width = p->width;
	request.height = p->height;
	enum exit_code code = inspect_see_through(inspect, &request);
	inspect->done += code == EXIT_DONE;
	return code;
}

static enum exit_code make_others(struct inspect *inspect)
{
	const struct candil_error error = {.code = CANDIL_STATUS_UNSUPPORTED,
					   .text = "the daemon tells nothing of its voxels: it is older than this candil"};
	enum exit_code code = EXIT_DONE;
	if (!inspect_others(&inspect->list, &inspect->job.options.request, &inspect->job.target.info))
		return job_fail(&inspect->job, &error);
	while (code == EXIT_DONE && inspect->done < inspect->list.count) {
		if (interrupt_seen())
			return job_fail_between(&inspect->job);
		code = make_picture(inspect);
	}
	return code;
}

// ---- the answer ------------------------------------------------------------------------------------------------------

static json_t *inspect_picture_json(const struct inspect *inspect, const struct inspect_picture *p)
{
	char name[PATH_MAX] = "";
	inspect_name(p, inspect->job.options.output, extension(inspect), name, sizeof(name));
	json_t *o = json_pack("{s:o,s:s,s:s,s:o}", "image", cli_json_text(name), "kind", p->kind, "show", p->show, "level",
			      cli_json_u64(p->level));
	if (p->slice != INSPECT_NO_SLICE) {
		json_object_set_new(o, "axis", json_pack("s#", &"xyz"[p->axis], 1));
		json_object_set_new(o, "slice", cli_json_u64(p->slice));
	}
	json_object_set_new(o, "width", cli_json_u64(p->width));
	json_object_set_new(o, "height", cli_json_u64(p->height));
	json_object_set_new(o, "bytes", cli_json_u64(p->bytes));
	json_object_set_new(o, "elapsed_us", cli_json_u64(p->done.elapsed_us));
	json_object_set_new(o, "stages", report_stages_json(&p->done));
	return o;
}

static json_t *inspect_answer_json(const struct inspect *inspect)
{
	const struct candil_done *first = &inspect->list.pictures[0].done;
	json_t *images = json_array();
	for (uint32_t i = 0; i < inspect->list.count; i++)
		json_array_append_new(images, inspect_picture_json(inspect, &inspect->list.pictures[i]));
	json_t *answer = json_pack(
	    "{s:o,s:o,s:s,s:o,s:s,s:o,s:o,s:o,s:o}", "scene", cli_json_text(inspect->job.options.scene), "scene_hash",
	    cli_json_text(inspect->job.target.info.hash), "technique",
	    candil_technique_name(inspect->job.accepted.technique), "device", cli_json_text(first->device), "format",
	    candil_format_name(inspect->job.options.request.format), "figures", report_figures_json(first), "stages",
	    report_stages_json(first), "elapsed_us", cli_json_u64(first->elapsed_us), "images", images);
	job_put_warnings(&inspect->job, answer);
	return answer;
}

// Write PREFIX.json, whole or not at all.
static enum exit_code inspect_write_json(struct inspect *inspect)
{
	char name[PATH_MAX];
	json_t *object = inspect_answer_json(inspect);
	char *text = object ? json_dumps(object, JSON_INDENT(2)) : NULL;
	json_decref(object);
	if (!text || snprintf(name, sizeof(name), "%s.json", inspect->job.options.output) >= (int)sizeof(name)) {
		errno = text ? ENAMETOOLONG : ENOMEM;
		free(text);
		return job_fail_output(&inspect->job, inspect->job.options.output);
	}
	const bool good = output_save(name, text, strlen(text));
	const int failure = errno;
	free(text);
	errno = failure;
	return good ? EXIT_DONE : job_fail_output(&inspect->job, name);
}

static void inspect_print_answer(const struct inspect *inspect)
{
	const struct candil_done *done = &inspect->list.pictures[0].done;
	printf("images     %" PRIu32 ", %s-….%s; figures in %s.json\n", inspect->list.count, inspect->job.options.output,
	       extension(inspect), inspect->job.options.output);
	printf("grid       %g x %g x %g voxels of %.6g m, %.0f entries\n", inspect_figure(done, "grid.x"),
	       inspect_figure(done, "grid.y"), inspect_figure(done, "grid.z"), inspect_figure(done, "voxel"),
	       inspect_figure(done, "entries"));
	for (uint32_t i = 0, told = 0; i < done->figure_count; i++) {
		const struct candil_figure *f = &done->figures[i];
		if (strncmp(f->name, "occupied.", 9) == 0)
			printf("%s%.3g %%", told++ ? ", " : "occupied   by level, from the voxels up: ", 100 * f->value);
	}
	printf("\nmemory     %.2f MiB: voxels %.2f, light %.2f, pyramid %.2f\n", inspect_figure(done, "bytes.all") * MIB,
	       inspect_figure(done, "bytes.voxels") * MIB, inspect_figure(done, "bytes.light") * MIB,
	       inspect_figure(done, "bytes.pyramid") * MIB);
	report_print_stages(done, stdout);
	if (inspect->framed)
		puts("camera     the scene has none: its bounds are framed");
}

static enum exit_code inspect_answer(struct inspect *inspect)
{
	progress_clear(&inspect->job.progress);
	enum exit_code code = inspect->job.cli->json ? EXIT_DONE : inspect_write_json(inspect);
	job_end(&inspect->job);
	if (inspect->job.cli->json)
		return cli_print_json(inspect_answer_json(inspect), stdout, EXIT_DONE);
	if (code != EXIT_DONE || inspect->job.options.quiet)
		return code;
	inspect_print_answer(inspect);
	return cli_flush(stdout, EXIT_DONE);
}

// ---- the command -----------------------------------------------------------------------------------------------------

// Make the names of the options that inspect sets itself.
static void name_own_options(struct inspect *inspect)
{
	const char *technique = candil_technique_name(inspect->job.options.request.technique);
	for (size_t i = 0; i < OWN_OPTIONS; i++)
		snprintf(inspect->own[i], sizeof(inspect->own[i]), "%s.%s", technique, own_words[i]);
}

// Check a parsed command line. Returns the sentence that says what inspect cannot take; NULL: it can take everything.
static const char *inspect_settle(struct inspect *inspect)
{
	const struct candil_render_request *r = &inspect->job.options.request;
	if (strcmp(inspect->job.options.output, "-") == 0)
		return "-o PREFIX is what the files' names begin with: there are several";
	if (!(technique_traits((unsigned)r->technique) & TECHNIQUE_VOXELS)) {
		char list[64];
		technique_list(TECHNIQUE_VOXELS, "or", list, sizeof(list));
		snprintf(inspect->wrong, sizeof(inspect->wrong), "--technique %s alone has voxels to inspect", list);
		return inspect->wrong;
	}
	name_own_options(inspect);
	if (r->option_count + OWN_OPTIONS > sizeof(inspect->job.options.settings) / sizeof(*inspect->job.options.settings))
		return "--set can be given 12 times at most";
	for (size_t i = 0; i < r->option_count; i++)
		for (size_t k = 0; k < OWN_OPTIONS; k++)
			if (strcmp(r->options[i].name, inspect->own[k]) == 0) {
				snprintf(inspect->wrong, sizeof(inspect->wrong),
					 "%s, %s, %s and %s are set by inspect: candil render takes them", inspect->own[0],
					 inspect->own[1], inspect->own[2], inspect->own[3]);
				return inspect->wrong;
			}
	return NULL;
}

// Find out before anything is computed whether the first file can be written.
static enum exit_code inspect_probe_output(struct inspect *inspect)
{
	char name[PATH_MAX];
	errno = ENAMETOOLONG;
	const bool good =
	    inspect_name(&inspect->list.pictures[0], inspect->job.options.output, extension(inspect), name, sizeof(name)) &&
	    output_probe(name);
	return good ? EXIT_DONE : job_fail_output(&inspect->job, inspect->job.options.output);
}

static enum exit_code do_inspect(struct inspect *inspect)
{
	struct candil_render_request *r = &inspect->job.options.request;
	inspect_first(&inspect->list, r);
	enum exit_code code = inspect_probe_output(inspect);
	if (code != EXIT_DONE)
		return code;
	code = job_open(&inspect->job);
	if (code != EXIT_DONE)
		return code;
	inspect->framed = !r->has_camera && !r->camera_name && inspect->job.target.info.camera_count == 0;
	if (inspect->framed)
		view_frame_bounds(&inspect->job.target.info, r);
	progress_say(&inspect->job.progress, "making voxels");
	code = make_picture(inspect);
	if (code == EXIT_DONE)
		code = make_others(inspect);
	return code == EXIT_DONE ? inspect_answer(inspect) : code;
}

static enum exit_code run_inspect(struct cli *cli, const struct command *self, int argc, char **argv)
{
	// Static because it is too large for the stack; a process runs one command.
	static struct inspect inspect;
	enum exit_code code = EXIT_DONE;
	memset(&inspect, 0, sizeof(inspect));
	inspect.job.cli = cli;
	if (!inspect_options_parse(cli, self, argc, argv, &inspect.job.options, &code))
		return code;
	const char *wrong = inspect_settle(&inspect);
	if (wrong)
		return cli_usage(self, "%s", wrong);
	inspect.job.stream = stdout;
	job_begin(&inspect.job);
	code = do_inspect(&inspect);
	job_end(&inspect.job);
	return code;
}

const struct command inspect_command = {
    .name = "inspect",
    .summary = "show the voxels of a scene, as pictures and figures",
    .help =
	"Usage: candil inspect SCENE -o PREFIX [options]\n\n"
	"The voxels that {voxels} follows light through, cell by cell, as they are: nothing is filtered. Files:\n\n"
	"  PREFIX-view-radiance.png   the first occupied cell along each pixel's ray: the light that it sends, W/(m² sr).\n"
	"                             Lamps that {voxels} aims at one by one are dark: cones are not to find them again\n"
	"  PREFIX-view-albedo.png     its diffuse albedo\n"
	"  PREFIX-view-normal.png     its normal, 0.5 + 0.5 times x, y, z, as the file's triangles wind\n"
	"  PREFIX-view-coverage.png   the share of its faces across x, y, z that surfaces hide, in red, green, blue\n"
	"  PREFIX-level-N-radiance.png  the same view of level N: cells of 2^N voxels along each side\n"
	"  PREFIX-slice-A-radiance.png, PREFIX-slice-A-coverage.png\n"
	"                             the slice through the middle of the scene's bounds across A = x, y or z, seen "
	"against\n"
	"                             that axis: x from +x with +y up, y from +y with -z up, z from +z with +y up. A cell\n"
	"                             is a whole number of pixels\n"
	"  PREFIX.json                figures and times; with --json they go to standard output instead\n\n"
	"Options are those of candil render but --progressive: --set {voxels}.resolution=256, --size WxH (which slices do "
	"not\n"
	"exceed, unless they have more cells), --camera, --format exr, --exposure EV, --light and so on; --spp is 1.\n"
	"A cell that holds the eye is looked through. `candil render --technique {voxels}\n"
	"--set {voxels}.show=none|albedo|normal|emission|irradiance|radiance|coverage`, with {voxels}.level=N, and\n"
	"{voxels}.axis=x|y|z with {voxels}.slice=K, makes any one of these pictures.\n\n"
	"--json: {\"scene\", \"scene_hash\", \"technique\", \"device\", \"format\", \"figures\": [{\"name\", \"value\", "
	"\"unit\"}],\n"
	"\"stages\": [{\"name\", \"us\"}], \"elapsed_us\", \"images\": [{\"image\", \"kind\": \"view\"|\"level\"|\"slice\", "
	"\"show\",\n"
	"\"level\", \"axis\", \"slice\" (of a slice), \"width\", \"height\", \"bytes\", \"elapsed_us\", \"stages\"}],\n"
	"\"warnings\": [] (about the scene), \"warnings_more\"}. Stages beside\n"
	"the figures are the first image's, for which the voxels were made, if the daemon had none yet. Figures: grid.x,\n"
	"grid.y, grid.z (cells), low.x, low.y, low.z (the grid's low corner), voxel (a cell's side), entries (voxels of\n"
	"surface, two at most a cell: by the way they face), occupied.0, occupied.1… (share of a level's cells), bytes.…,\n"
	"levels, cones, bounces.\n"
	"Exit codes: 0 every file is written; others as in candil --help. Files already written stay.\n",
    .run = run_inspect,
};
