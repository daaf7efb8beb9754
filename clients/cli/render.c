// render: one picture of one scene.
#include <errno.h>
#include <string.h>

#include "clients/cli/job.h"
#include "clients/cli/output.h"
#include "clients/cli/report.h"
#include "clients/cli/view.h"
#include "protocol/names.h"

struct render {
	struct job job;
	struct output output;
	struct report report;
	struct candil_image final; // its `data` is this command's to free
};

// Choose the camera, and its word in the report.
static void render_choose_camera(struct render *render)
{
	struct candil_render_request *request = &render->job.options.request;
	if (request->has_camera || request->camera_name) {
		render->report.camera = request->has_camera ? "given" : "scene";
		return;
	}
	render->report.camera = render->job.target.info.camera_count > 0 ? "scene" : "framed";
	if (render->job.target.info.camera_count == 0)
		view_frame_bounds(&render->job.target.info, request);
}

// Take one event of the render. false: the output cannot be written, errno says why.
static bool render_take_event(void *user, const struct candil_event *event)
{
	struct render *render = user;
	switch (event->kind) {
	case CANDIL_EVENT_ACCEPTED:
		job_take_accepted(&render->job, &event->u.accepted);
		render->report.accepted = event->u.accepted;
		return true;
	case CANDIL_EVENT_PROGRESS:
		progress_draw(&render->job.progress, &event->u.progress);
		return true;
	case CANDIL_EVENT_IMAGE:
		if (event->u.image.final) {
			candil_keep_image(render->job.target.client, &event->u.image);
			render->final = event->u.image;
			return true;
		}
		return !render->output.place.can_replace ||
		       output_write(&render->output, event->u.image.data, event->u.image.bytes);
	case CANDIL_EVENT_DONE:
		render->report.done = event->u.done;
		render->report.bytes = render->final.bytes;
		render->report.made_width = render->final.made_width;
		render->report.made_height = render->final.made_height;
		return output_write(&render->output, render->final.data, render->final.bytes);
	default:
		return true;
	}
}

static enum exit_code render_see_through(struct render *render)
{
	struct candil_error error;
	uint32_t id;
	if (candil_submit_render(render->job.target.client, &render->job.options.request, &id, &error) != CANDIL_STATUS_OK)
		return job_fail(&render->job, &error);
	return job_follow(&render->job, id, render_take_event, render);
}

static enum exit_code render_say_report(struct render *render)
{
	const enum exit_code code = strcmp(render->report.done.reason, "time") == 0 ? EXIT_DEADLINE : EXIT_DONE;
	progress_clear(&render->job.progress);
	job_end(&render->job);
	render->report.options = &render->job.options;
	render->report.scene = &render->job.target.info;
	render->report.images = render->output.count;
	if (render->job.cli->json) {
		json_t *answer = report_json(&render->report);
		job_put_warnings(&render->job, answer);
		return cli_print_json(answer, render->job.stream, code);
	}
	if (render->job.options.quiet)
		return code;
	report_print(&render->report, render->job.stream);
	return cli_flush(render->job.stream, code);
}

static enum exit_code render_image(struct render *render)
{
	// The output is opened first, so that no render is wasted on one that cannot be written.
	if (!output_open(&render->output, render->job.options.output))
		return job_fail_output(&render->job, render->job.options.output);
	enum exit_code code = job_open(&render->job);
	if (code != EXIT_DONE)
		return code;
	render_choose_camera(render);
	progress_say(&render->job.progress, "rendering");
	code = render_see_through(render);
	return code == EXIT_DONE ? render_say_report(render) : code;
}

static enum exit_code run_render(struct cli *cli, const struct command *self, int argc, char **argv)
{
	// Static because it is too large for the stack; a process runs one command.
	static struct render render;
	enum exit_code code = EXIT_DONE;
	memset(&render, 0, sizeof(render));
	render.output = (struct output)OUTPUT_NONE;
	render.job.cli = cli;
	if (!render_options_parse(cli, self, argc, argv, &render.job.options, &code))
		return code;
	render.job.stream = strcmp(render.job.options.output, "-") == 0 ? stderr : stdout;
	job_begin(&render.job);
	code = render_image(&render);
	job_end(&render.job);
	output_close(&render.output);
	candil_free(render.final.data);
	return code;
}

#define EXIT_CODES_HELP \
	"Exit codes: 0 image written, 1 anything else, 2 usage, 3 cannot connect, 4 scene, 5 device, 6 memory,\n" \
	"7 the deadline passed (the best picture by then is written), 8 cancelled, 9 worker lost (candil --help says " \
	"more).\n"

const struct command render_command = {
    .name = "render",
    .summary = "make a picture of a scene",
    .help =
	"Usage: candil render SCENE -o OUT.exr|OUT.png|OUT.ply|OUT.mtx|- [options] [--connect ADDR] [--json]\n\n"
	"SCENE is the name of a loaded scene, or a file (glTF, GLB, OBJ). A file is loaded into the daemon for the\n"
	"call; where no daemon runs and no --connect is given, a private one is started that ends with the call.\n\n"
	"  -o, --output FILE     by extension .exr (linear, float) or .png (sRGB); - is standard output. Of {patches} also\n"
	"                        what it computes with: .ply, its patches with their radiosity, and .mtx, the form factors\n"
	"                        between their sides\n"
	"                        A file that is there is replaced whole and keeps its owner and mode; where that cannot\n"
	"                        be (its folder takes no files, its owner is another), it is written over. A link to a\n"
	"                        file stays; one that leads nowhere is replaced. A pipe waits for its reader\n"
	"  --format exr|png|ply|mtx  whatever the output's name; default for -: png\n"
	"  --half, --float       EXR with 16 or 32 bits; default --float\n"
	"  --technique NAME      auto ({auto}; with --error or --time the best that candil quote knows), {techniques}; "
	"default "
	"auto\n"
	"  --size WxH            pixels; default 512x512\n"
	"  --spp N               samples per pixel; default 64 of {noise}, 1 of the others, which have no noise\n"
	"  --first-sample N      index of the first sample; disjoint ranges can be merged\n"
	"  --seed N              another seed, another noise\n"
	"  --error E             end once the relative MSE is at most E nine times of ten; then --spp is the most, default "
	"65536\n"
	"  --time MS             end with what is there so long after the request came; likewise. Without noise no more\n"
	"                        than one sample is taken unless --spp says so. If there is no time for one of every "
	"pixel,\n"
	"                        the picture is made of fewer pixels, scaled up, and says so; the time that finding out\n"
	"                        how many took is told as \"size\"\n"
	"  --whole               with --time: no picture rather than one of fewer pixels\n"
	"  --camera NAME         of the scene; default: its first, else its bounds are framed\n"
	"  --camera ex,ey,ez,tx,ty,tz,ux,uy,uz,VFOV\n"
	"                        eye, target, up in metres; vertical angle in degrees\n"
	"  --orthographic H      parallel rays, the picture being H metres high\n"
	"  --panorama            all directions: longitude across, latitude down, the target in the middle\n"
	"  --lens RADIUS,FOCUS   a lens instead of a pinhole, in metres: sharp at that distance along the view axis\n"
	"  --filter box|gauss|bh what a pixel takes of the light around its middle; default box\n" EDIT_OPTIONS_HELP
	"  --animation NAME      the scene as this animation of the file has it, --at S seconds after its start; "
	"default 0\n"
	"  --background r,g,b    radiance, W/(m² sr), that rays meet which leave the scene; default black\n"
	"  --background PICTURE  a picture of all directions (exr, hdr, tiff, png, jpeg, twice as wide as high), seen\n"
	"                        around the scene, and a light. As SCENE, the name of a loaded one or a file\n"
	"  --background-turn DEG of the picture about +Y, counter-clockwise seen from above; 0: its middle is along -Z\n"
	"  --background-scale S  W/(m² sr) of its unit; default 1\n"
	"  --no-default-light    a scene that nothing gives light to stays black; else a neutral sky lights it\n"
	"  --effects LIST        auto, all or none, then +NAME or -NAME; a NAME is {effects}:\n"
	"                        \"auto,-textures\", \"none,+emitters\"; default auto, what the scene has\n"
	"  --aov LIST            depth, normal, albedo, id: extra channels of an EXR\n"
	"  --exposure EV         PNG: times 2^EV\n"
	"  --view NAME           PNG: none, reinhard, filmic; default none\n"
	"  --progressive         write intermediate images to the output while rendering\n"
	"  --set NAME=VALUE      an option of a technique: " TECHNIQUE_OPTION_EXAMPLE "; may be repeated.\n"
	"                        " TECHNIQUE_OPTION_IMPORT "=FILE takes patches or form factors from a .ply or .mtx\n"
	"  --up y|z              OBJ: which axis points up; default y\n"
	"  --unit METRES         OBJ: length of a unit; default 1\n"
	"  --quiet               no progress, no summary; warnings about the scene alone\n\n"
	"Ctrl-C cancels the request; what --progressive has written stays.\n"
	"A progress bar is drawn if standard error is a terminal. The summary, or with --json one object, goes to\n"
	"standard output, or to standard error with -o -. What was mended or left out of the scene and shows in the "
	"picture\n"
	"is told on standard error, or with --json as \"warnings\".\n\n"
	"--json: " REPORT_JSON_HELP "\n" EXIT_CODES_HELP,
    .run = run_render,
};
