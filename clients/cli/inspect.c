// inspect: the voxels or the patches of a scene as pictures and figures.
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/inspect_files.h"
#include "clients/cli/interrupt.h"
#include "clients/cli/output.h"
#include "clients/cli/view.h"
#include "protocol/names.h"

static const char *const own_words[OWN_OPTIONS] = {"show", "level", "axis", "slice"};

static uint32_t own_count(const struct inspect *inspect)
{
	return inspect->patches ? OWN_SHOW + 1 : OWN_OPTIONS;
}

// ---- the pictures ----------------------------------------------------------------------------------------------------

static bool inspect_write_image(const struct inspect *inspect, struct inspect_picture *p, const struct candil_image *image)
{
	char name[PATH_MAX];
	if (!inspect_name(p, inspect->job.options.output, inspect_extension(inspect), name, sizeof(name))) {
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

// The options of a picture of voxels beside the user's.
static size_t add_cells(const struct inspect *inspect, const struct inspect_picture *p, char text[3][16],
			struct candil_option *options)
{
	size_t count = 0;
	snprintf(text[0], sizeof(text[0]), "%" PRIu32, p->level);
	snprintf(text[1], sizeof(text[1]), "%c", "xyz"[p->axis]);
	snprintf(text[2], sizeof(text[2]), "%" PRIu32, p->slice);
	options[count++] = (struct candil_option){inspect->own[OWN_LEVEL], text[0]};
	if (p->slice != INSPECT_NO_SLICE) {
		options[count++] = (struct candil_option){inspect->own[OWN_AXIS], text[1]};
		options[count++] = (struct candil_option){inspect->own[OWN_SLICE], text[2]};
	}
	return count;
}

// Choose the exposure of a PNG of patches' light, unless the user did. false: what it should be is not known.
static bool settle_white(const struct inspect *inspect, struct inspect_picture *p, struct candil_render_request *request)
{
	const double white = inspect_white(&inspect->list, p);
	if (request->format != CANDIL_FORMAT_PNG || !(white > 0))
		return false;
	if (fabs(request->exposure_ev) <= 0)
		request->exposure_ev = fmax(fmin(-log2(white), LIMIT_EXPOSURE_EV), -LIMIT_EXPOSURE_EV);
	p->white = exp2(-request->exposure_ev);
	return true;
}

// Make the next picture of the list.
static enum exit_code make_picture(struct inspect *inspect)
{
	struct inspect_picture *p = &inspect->list.pictures[inspect->done];
	struct candil_render_request request = inspect->job.options.request;
	struct candil_option options[INSPECT_SETTINGS];
	char text[3][16];
	size_t count = inspect_settings(inspect, p->show, options);
	options[count++] = (struct candil_option){inspect->own[OWN_SHOW], p->show};
	if (!inspect->patches)
		count += add_cells(inspect, p, text, &options[count]);
	request.options = options;
	request.option_count = count;
	request.width = p->width;
	request.height = p->height;
	(void)settle_white(inspect, p, &request);
	enum exit_code code = inspect_see_through(inspect, &request);
	// How large a residual is its own picture tells.
	if (code == EXIT_DONE && !(p->white > 0) && settle_white(inspect, p, &request))
		code = inspect_see_through(inspect, &request);
	inspect->done += code == EXIT_DONE;
	return code;
}

static enum exit_code make_others(struct inspect *inspect)
{
	const struct candil_error error = {.code = CANDIL_STATUS_UNSUPPORTED,
					   .text = "the daemon tells nothing of its voxels: it is older than this candil"};
	enum exit_code code = EXIT_DONE;
	if (!inspect->patches && !inspect_others(&inspect->list, &inspect->job.options.request, &inspect->job.target.info))
		return job_fail(&inspect->job, &error);
	while (code == EXIT_DONE && inspect->done < inspect->list.count) {
		if (interrupt_seen())
			return job_fail_between(&inspect->job);
		code = make_picture(inspect);
	}
	return code;
}

// ---- the answer ------------------------------------------------------------------------------------------------------

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

static enum exit_code inspect_answer(struct inspect *inspect)
{
	progress_clear(&inspect->job.progress);
	enum exit_code code = inspect->job.cli->json ? EXIT_DONE : inspect_write_json(inspect);
	job_end(&inspect->job);
	if (inspect->job.cli->json)
		return cli_print_json(inspect_answer_json(inspect), stdout, inspect_files_exit_code(inspect));
	if (code != EXIT_DONE)
		return code;
	inspect_print_lacking(inspect);
	if (inspect->job.options.quiet)
		return inspect_files_exit_code(inspect);
	inspect_print_answer(inspect);
	return cli_flush(stdout, inspect_files_exit_code(inspect));
}

// ---- the command -----------------------------------------------------------------------------------------------------

// Make the names of the options that inspect sets itself.
static void name_own_options(struct inspect *inspect)
{
	const char *technique = candil_technique_name(inspect->job.options.request.technique);
	for (size_t i = 0; i < OWN_OPTIONS; i++)
		snprintf(inspect->own[i], sizeof(inspect->own[i]), "%s.%s", technique, own_words[i]);
	if (inspect->patches)
		snprintf(inspect->row, sizeof(inspect->row), "%s." INSPECT_SHOW_ROW, technique);
}

// The sentence on an option that inspect sets itself, or NULL.
static const char *find_own_option(struct inspect *inspect)
{
	const struct candil_render_request *r = &inspect->job.options.request;
	const char *names[OWN_OPTIONS];
	char list[128];
	for (size_t k = 0; k < own_count(inspect); k++)
		names[k] = inspect->own[k];
	names_list(names, own_count(inspect), "and", list, sizeof(list));
	for (size_t i = 0; i < r->option_count; i++)
		for (size_t k = 0; k < own_count(inspect); k++)
			if (strcmp(r->options[i].name, inspect->own[k]) == 0) {
				snprintf(inspect->wrong, sizeof(inspect->wrong),
					 "%s %s set by inspect: candil render takes %s", list,
					 own_count(inspect) > 1 ? "are" : "is", own_count(inspect) > 1 ? "them" : "it");
				return inspect->wrong;
			}
	return NULL;
}

// Check a parsed command line. Returns the sentence that says what inspect cannot take; NULL: it can take everything.
static const char *inspect_settle(struct inspect *inspect)
{
	const struct candil_render_request *r = &inspect->job.options.request;
	const unsigned traits = technique_traits((unsigned)r->technique);
	if (strcmp(inspect->job.options.output, "-") == 0)
		return "-o PREFIX is what the files' names begin with: there are several";
	if (!(traits & (TECHNIQUE_VOXELS | TECHNIQUE_PATCHES))) {
		char voxels[64], patches[64];
		technique_list(TECHNIQUE_VOXELS, "or", voxels, sizeof(voxels));
		technique_list(TECHNIQUE_PATCHES, "or", patches, sizeof(patches));
		snprintf(inspect->wrong, sizeof(inspect->wrong),
			 "--technique %s has voxels to inspect, --technique %s has patches; others have neither", voxels,
			 patches);
		return inspect->wrong;
	}
	inspect->patches = traits & TECHNIQUE_PATCHES;
	name_own_options(inspect);
	if (r->option_count + own_count(inspect) > INSPECT_SETTINGS) {
		snprintf(inspect->wrong, sizeof(inspect->wrong), "--set can be given %zu times at most",
			 INSPECT_SETTINGS - own_count(inspect));
		return inspect->wrong;
	}
	return find_own_option(inspect);
}

// Find out before anything is computed whether the first file can be written.
static enum exit_code inspect_probe_output(struct inspect *inspect)
{
	char name[PATH_MAX];
	errno = ENAMETOOLONG;
	const bool good = inspect_name(&inspect->list.pictures[0], inspect->job.options.output, inspect_extension(inspect),
				       name, sizeof(name)) &&
			  output_probe(name);
	return good ? EXIT_DONE : job_fail_output(&inspect->job, inspect->job.options.output);
}

static enum exit_code do_inspect(struct inspect *inspect)
{
	struct candil_render_request *r = &inspect->job.options.request;
	inspect_first(&inspect->list, inspect->patches, r);
	enum exit_code code = inspect_name_files(inspect) ? inspect_probe_output(inspect)
							  : job_fail_output(&inspect->job, inspect->job.options.output);
	if (code != EXIT_DONE)
		return code;
	code = job_open(&inspect->job);
	if (code != EXIT_DONE)
		return code;
	inspect->framed = !r->has_camera && !r->camera_name && inspect->job.target.info.camera_count == 0;
	if (inspect->framed)
		view_frame_bounds(&inspect->job.target.info, r);
	inspect->lacks_factors = inspect->patches && inspect->job.target.imported.solution;
	if (inspect->lacks_factors)
		inspect_leave_out_factors(&inspect->list);
	progress_say(&inspect->job.progress, inspect->patches ? "making patches" : "making voxels");
	code = make_picture(inspect);
	if (code == EXIT_DONE)
		code = make_others(inspect);
	if (code == EXIT_DONE && inspect->patches)
		code = inspect_make_files(inspect);
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
    .summary = "show the voxels or the patches of a scene, as pictures and figures",
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
	"With --technique {patches} the patches between which light goes, each of one colour, and their form factors:\n\n"
	"  PREFIX-albedo.png          diffuse albedo\n"
	"  PREFIX-b.png               radiosity B = M + albedo H, W/m²\n"
	"  PREFIX-e.png               of that M, what they emit\n"
	"  PREFIX-residual.png        what the solver has left over of B, W/m²: its magnitude\n"
	"                             White in these three is the largest value (of B of what is no lamp), which the "
	"answer\n"
	"                             tells, or 2^-EV W/m² with --exposure EV; with --format exr values are as they are\n"
	"  PREFIX-id.png              another colour for each side of each patch\n"
	"  PREFIX-normal.png          normal, 0.5 + 0.5 times x, y, z, of the side that is seen\n"
	"  PREFIX-row.png             the form factors from the patch in the middle of the picture, or from the side of a\n"
	"                             patch of --set {patches}.row=N; its largest is 1\n"
	"  PREFIX-patches.ply         corners of the patches, and for each of their sides B, M, albedo, area…\n"
	"  PREFIX-factors.mtx         their form factors as a sparse matrix (Matrix Market), rows and columns in the order\n"
	"                             of the PLY's faces. `candil render -o` makes these two, too: FILE.ply, FILE.mtx\n"
	"  PREFIX.json                as above\n\n"
	"Options are those of candil render but --progressive: --set {voxels}.resolution=256, --size WxH (which slices do "
	"not\n"
	"exceed, unless they have more cells), --camera, --format exr, --exposure EV, --light and so on; --spp is 1, and\n"
	"the technique, where none is given, {voxels}. There is no default light, and without light there are no form "
	"factors.\n"
	"With --set {patches}.import=FILE.ply, a solution, what takes form factors is left out, and the answer says so.\n"
	"A cell that holds the eye is looked through. `candil render --technique {voxels}\n"
	"--set {voxels}.show=none|albedo|normal|emission|irradiance|radiance|coverage`, with {voxels}.level=N, and\n"
	"{voxels}.axis=x|y|z with {voxels}.slice=K, makes any one of these pictures; and so does\n"
	"`--technique {patches} --set {patches}.show=none|b|e|albedo|id|normal|residual|row`.\n\n"
	"--json: {\"scene\", \"scene_hash\", \"technique\", \"device\", \"format\", \"figures\": [{\"name\", \"value\", "
	"\"unit\"}],\n"
	"\"stages\": [{\"name\", \"us\"}], \"elapsed_us\", \"images\": [{\"image\", \"kind\": "
	"\"view\"|\"level\"|\"slice\"|\"patches\",\n"
	"\"show\", \"level\" (of voxels), \"axis\", \"slice\" (of a slice), \"width\", \"height\", \"bytes\", "
	"\"elapsed_us\", "
	"\"stages\", \"white\" (W/m² that a PNG shows as 1, of light of patches)}],\n"
	"\"files\": [{\"file\", \"bytes\", \"elapsed_us\", \"stages\"}] (of patches), \"left_out\": [] (of "
	"\"residual\",\n"
	"\"row\" and \"factors\": all that an imported solution has nothing for),\n"
	"\"warnings\": [] (about the scene), \"warnings_more\"}. Stages and\n"
	"elapsed_us beside the figures are those of all images and files together, the figures the first image's: of\n"
	"voxels: grid.x, grid.y, grid.z (cells), low.x, low.y, low.z (the grid's low corner), voxel (a cell's side), "
	"entries\n"
	"(voxels of surface, two at most a cell: by the way they face), occupied.0, occupied.1… (share of a level's "
	"cells),\n"
	"bytes.…, levels, cones, bounces. Of patches: patches, edge (m), check.rows and check.factors (rows of form "
	"factors\n"
	"that light reaches, and their entries), sum.least, sum.mean, sum.most (a row's sum; 1 in a closed room), "
	"sum.all.…\n"
	"(with the share that meets nothing: 1), reciprocity.mean and reciprocity.most (how far area times factor there "
	"and\n"
	"back differ, as a share of the larger; the mean is by light exchanged), reciprocity.chance (of rows by rays: what\n"
	"the mean would be about if they were independent), b.most and reflected.most (W/m²), values.1e-1 (factors of 0.1 "
	"and "
	"more),\n"
	"values.1e-2 (of 0.01 to 0.1)… values.0 (below 1e-7), and those of every such render.\n"
	"Exit codes: 0 every file is written; others as in candil --help. Files already written stay. A PREFIX-factors.mtx\n"
	"that would be too large is told, in the JSON as \"error\" in place of \"bytes\"; all else is written, and the exit "
	"code is 1.\n",
    .run = run_inspect,
};
