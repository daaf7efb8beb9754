#include "clients/cli/render_options.h"

#include <string.h>
#include <strings.h>

#include "clients/cli/render_values.h"
#include "clients/cli/scene_options.h"
#include "protocol/limits.h"

#define OPEN_SAMPLES 65536u

enum {
	OPTION_OUTPUT = 'o',
	OPTION_FORMAT = 1200,
	OPTION_TECHNIQUE,
	OPTION_SIZE,
	OPTION_SPP,
	OPTION_FIRST_SAMPLE,
	OPTION_SEED,
	OPTION_CAMERA,
	OPTION_BACKGROUND,
	OPTION_BACKGROUND_TURN,
	OPTION_BACKGROUND_SCALE,
	OPTION_EFFECTS,
	OPTION_AOV,
	OPTION_EXPOSURE,
	OPTION_VIEW,
	OPTION_HALF,
	OPTION_FLOAT,
	OPTION_PROGRESSIVE,
	OPTION_SET,
	OPTION_QUIET,
	OPTION_ORBIT,
	OPTION_CAMERAS,
	OPTION_SHARD,
	OPTION_FORCE,
	OPTION_KEYS,
	OPTION_FRAMES,
	OPTION_FPS,
	OPTION_ERROR,
	OPTION_TIME,
	OPTION_FILTER,
	OPTION_LENS,
	OPTION_ORTHOGRAPHIC,
	OPTION_PANORAMA,
};

// One option a line: formatted, the list could not be read.
// clang-format off
#define SHARED_OPTIONS \
	CLI_COMMON_OPTIONS, \
	SCENE_OPTIONS, \
	EDIT_OPTIONS, \
	{"output", required_argument, NULL, OPTION_OUTPUT}, \
	{"format", required_argument, NULL, OPTION_FORMAT}, \
	{"technique", required_argument, NULL, OPTION_TECHNIQUE}, \
	{"size", required_argument, NULL, OPTION_SIZE}, \
	{"spp", required_argument, NULL, OPTION_SPP}, \
	{"first-sample", required_argument, NULL, OPTION_FIRST_SAMPLE}, \
	{"seed", required_argument, NULL, OPTION_SEED}, \
	{"background", required_argument, NULL, OPTION_BACKGROUND}, \
	{"background-turn", required_argument, NULL, OPTION_BACKGROUND_TURN}, \
	{"background-scale", required_argument, NULL, OPTION_BACKGROUND_SCALE}, \
	{"effects", required_argument, NULL, OPTION_EFFECTS}, \
	{"aov", required_argument, NULL, OPTION_AOV}, \
	{"exposure", required_argument, NULL, OPTION_EXPOSURE}, \
	{"view", required_argument, NULL, OPTION_VIEW}, \
	{"half", no_argument, NULL, OPTION_HALF}, \
	{"float", no_argument, NULL, OPTION_FLOAT}, \
	{"set", required_argument, NULL, OPTION_SET}, \
	{"camera", required_argument, NULL, OPTION_CAMERA}, \
	{"error", required_argument, NULL, OPTION_ERROR}, \
	{"time", required_argument, NULL, OPTION_TIME}, \
	{"filter", required_argument, NULL, OPTION_FILTER}, \
	{"lens", required_argument, NULL, OPTION_LENS}, \
	{"orthographic", required_argument, NULL, OPTION_ORTHOGRAPHIC}, \
	{"panorama", no_argument, NULL, OPTION_PANORAMA}, \
	{"quiet", no_argument, NULL, OPTION_QUIET}
// clang-format on

static const struct option render_table[] = {
    SHARED_OPTIONS,
    {"at", required_argument, NULL, OPTION_AT},
    {"progressive", no_argument, NULL, OPTION_PROGRESSIVE},
    {NULL, 0, NULL, 0},
};

static const struct option inspect_table[] = {
    SHARED_OPTIONS,
    {"at", required_argument, NULL, OPTION_AT},
    {NULL, 0, NULL, 0},
};

static const struct option sweep_table[] = {
    SHARED_OPTIONS,
    {"orbit", required_argument, NULL, OPTION_ORBIT},
    {"cameras", required_argument, NULL, OPTION_CAMERAS},
    {"shard", required_argument, NULL, OPTION_SHARD},
    {"keys", required_argument, NULL, OPTION_KEYS},
    {"frames", required_argument, NULL, OPTION_FRAMES},
    {"fps", required_argument, NULL, OPTION_FPS},
    {"force", no_argument, NULL, OPTION_FORCE},
    {NULL, 0, NULL, 0},
};

// What was given, as far as it must fit together.
struct given {
	const char *format;
	bool half, single, exposure, view, turn, scale, orthographic, panorama;
	const char *word; // of a list: the one that is wrong
};

static const char *effects_form(void)
{
	static char text[512]; // said once, at the end of the program
	size_t used =
	    (size_t)snprintf(text, sizeof(text), "auto, all or none, then +NAME or -NAME, between commas; a NAME is ");
	for (unsigned i = 0; i < CANDIL_EFFECT_COUNT && used < sizeof(text); i++)
		used += (size_t)snprintf(text + used, sizeof(text) - used, "%s%s",
					 i == 0                         ? ""
					 : i == CANDIL_EFFECT_COUNT - 1 ? " or "
									: ", ",
					 candil_effect_name((enum candil_effect)i));
	return text;
}

// What an option takes, for a sentence.
static const char *form_of(int option)
{
	switch (option) {
	case OPTION_OUTPUT:
		return "a file name, or - for standard output";
	case OPTION_FORMAT:
		return "exr or png";
	case OPTION_TECHNIQUE:
		return "auto, pt, vct or direct";
	case OPTION_SIZE:
		return "WxH, two whole numbers of pixels such as 640x480";
	case OPTION_SPP:
		return "a whole number from 1 to 16777216";
	case OPTION_FIRST_SAMPLE:
		return "a whole number from 0 to 16777215";
	case OPTION_SEED:
		return "a whole number from 0 on";
	case OPTION_CAMERA:
		return "the name of a camera, or ten numbers: ex,ey,ez,tx,ty,tz,ux,uy,uz,VFOV";
	case OPTION_BACKGROUND:
		return "r,g,b, three numbers such as 1,1,1, or a picture: its name or its file";
	case OPTION_BACKGROUND_TURN:
		return "a number of degrees";
	case OPTION_BACKGROUND_SCALE:
		return "a number above 0";
	case OPTION_EFFECTS:
		return effects_form();
	case OPTION_AOV:
		return "depth, normal, albedo and id, between commas";
	case OPTION_EXPOSURE:
		return "a number of stops such as -1.5";
	case OPTION_VIEW:
		return "none, reinhard or filmic";
	case OPTION_SET:
		return "NAME=VALUE such as pt.depth=8, up to 16 times";
	case OPTION_ERROR:
		return "a relative MSE above 0 such as 1e-3";
	case OPTION_TIME:
		return "a whole number of milliseconds from 1 to 86400000";
	case OPTION_FILTER:
		return "box, gauss or bh";
	case OPTION_LENS:
		return "RADIUS,FOCUS, two lengths in metres such as 0.02,3.5";
	case OPTION_ORTHOGRAPHIC:
		return "the height of the picture in metres, above 0";
	case OPTION_UP:
		return "y or z";
	case OPTION_UNIT:
		return "a length in metres above 0";
	default:
		return edit_option_form(option);
	}
}

static bool parse_setting(char *text, struct render_options *options)
{
	char *equals = strchr(text, '=');
	size_t room = sizeof(options->settings) / sizeof(options->settings[0]);
	if (!equals || equals == text || equals[1] == '\0' || options->request.option_count == room)
		return false;
	*equals = '\0';
	options->settings[options->request.option_count++] = (struct candil_option){text, equals + 1};
	return true;
}

// One option with its value. false: the value is wrong.
static bool take_option(int option, char *value, struct render_options *options, struct given *given)
{
	struct candil_render_request *r = &options->request;
	switch (option) {
	case OPTION_OUTPUT:
		options->output = value;
		return *value != '\0';
	case OPTION_FORMAT:
		given->format = value;
		return strcmp(value, "exr") == 0 || strcmp(value, "png") == 0;
	case OPTION_TECHNIQUE:
		return value_technique(value, r);
	case OPTION_SIZE:
		return value_size(value, r);
	case OPTION_SPP:
		return cli_parse_u32(value, &r->samples) && r->samples > 0 && r->samples <= LIMIT_SAMPLES;
	case OPTION_FIRST_SAMPLE:
		return cli_parse_u32(value, &r->first_sample) && r->first_sample < LIMIT_SAMPLES;
	case OPTION_SEED:
		return cli_parse_u64(value, &r->seed);
	case OPTION_CAMERA:
		return value_camera(value, r);
	case OPTION_BACKGROUND:
		return value_background(value, r);
	case OPTION_BACKGROUND_TURN:
		given->turn = true;
		return cli_parse_double(value, &r->environment_turn_degrees);
	case OPTION_BACKGROUND_SCALE:
		given->scale = true;
		return cli_parse_double(value, &r->environment_scale) && r->environment_scale > 0;
	case OPTION_EFFECTS:
		return value_effects(value, r, &given->word);
	case OPTION_AOV:
		return value_aovs(value, r, &given->word);
	case OPTION_EXPOSURE:
		given->exposure = true;
		return cli_parse_double(value, &r->exposure_ev);
	case OPTION_VIEW:
		given->view = true;
		return value_view(value, r);
	case OPTION_ERROR:
		return cli_parse_double(value, &r->target_error) && r->target_error > 0;
	case OPTION_TIME:
		return cli_parse_u32(value, &r->deadline_ms) && r->deadline_ms > 0 && r->deadline_ms <= LIMIT_DEADLINE_MS;
	case OPTION_FILTER:
		return value_filter(value, r);
	case OPTION_LENS:
		return value_lens(value, &r->lens);
	case OPTION_ORTHOGRAPHIC:
		given->orthographic = true;
		return value_orthographic(value, &r->lens);
	case OPTION_SET:
		return parse_setting(value, options);
	case OPTION_UP:
	case OPTION_UNIT:
		return scene_option(option, value, &options->load);
	default:
		return edit_is_option(option) && edit_option(option, value, &options->edits);
	}
}

static bool take_flag(int option, struct render_options *options, struct given *given)
{
	switch (option) {
	case OPTION_HALF:
		given->half = true;
		return true;
	case OPTION_FLOAT:
		given->single = true;
		return true;
	case OPTION_PROGRESSIVE:
		options->request.progressive = true;
		return true;
	case OPTION_PANORAMA:
		given->panorama = true;
		options->request.lens.projection = CANDIL_PROJECTION_PANORAMA;
		return true;
	case OPTION_QUIET:
		options->quiet = true;
		return true;
	default:
		return false;
	}
}

// What a sweep alone takes. false: it is another option.
static bool take_sweep_option(int option, const char *value, struct sweep_texts *texts)
{
	switch (option) {
	case OPTION_ORBIT:
		texts->orbit = value;
		return true;
	case OPTION_CAMERAS:
		texts->cameras = value;
		return true;
	case OPTION_KEYS:
		texts->keys = value;
		return true;
	case OPTION_FRAMES:
		texts->frames = value;
		return true;
	case OPTION_FPS:
		texts->fps = value;
		return true;
	case OPTION_SHARD:
		texts->shard = value;
		return true;
	case OPTION_FORCE:
		texts->force = true;
		return true;
	default:
		return false;
	}
}

static const char *format_of(const struct render_options *options, const struct given *given)
{
	if (given->format)
		return given->format;
	if (strcmp(options->output, "-") == 0)
		return "png";
	const char *dot = strrchr(options->output, '.');
	if (dot && strcasecmp(dot, ".exr") == 0)
		return "exr";
	return dot && strcasecmp(dot, ".png") == 0 ? "png" : NULL;
}

// The sentence that says what does not fit together, or NULL.
static const char *settle_format(struct render_options *options, const struct given *given)
{
	const char *format = format_of(options, given);
	if (!format)
		return "the output's name ends in neither .exr nor .png; say --format exr or --format png";
	if (given->half && given->single)
		return "--half and --float exclude each other";
	if (strcmp(format, "exr") == 0) {
		options->request.format = given->half ? CANDIL_FORMAT_EXR_HALF : CANDIL_FORMAT_EXR_FLOAT;
		return given->exposure || given->view ? "an EXR holds linear radiance: --exposure and --view are for PNG"
						      : NULL;
	}
	options->request.format = CANDIL_FORMAT_PNG;
	if (given->half || given->single)
		return "--half and --float are for EXR";
	return options->request.aovs ? "--aov needs EXR output" : NULL;
}

// The sentence that says which option would do nothing, or NULL.
static const char *find_idle(const struct render_options *options, const struct given *given)
{
	if (given->orthographic && given->panorama)
		return "--orthographic and --panorama exclude each other";
	if ((given->turn || given->scale) && !options->request.environment)
		return "--background-turn and --background-scale are of a picture: name it with --background PICTURE";
	if (options->edits.at && !options->edits.edits.animation)
		return "--at is a time of an animation: name it with --animation NAME";
	return NULL;
}

// Without --spp: as many as the technique needs for a picture to look at. Those without noise need one, and where something
// else is to end it there are as many as will ever do.
static void settle_samples(struct candil_render_request *request)
{
	struct candil_render_request usual;
	candil_render_request_init(&usual);
	const bool noisy = request->technique != CANDIL_TECHNIQUE_DIRECT && request->technique != CANDIL_TECHNIQUE_VCT;
	const bool open = request->target_error > 0 || request->deadline_ms > 0;
	if (request->samples == 0)
		request->samples = noisy && open ? OPEN_SAMPLES : noisy ? usual.samples : 1;
}

static void init(struct render_options *options)
{
	memset(options, 0, sizeof(*options));
	candil_render_request_init(&options->request);
	options->request.samples = 0;
	options->request.options = options->settings;
	edit_options_init(&options->edits);
}

// Into options that were begun with init. `format`: of an output whose name says none; NULL: it must.
static bool parse(struct cli *cli, const struct command *self, int argc, char **argv, const struct option *long_options,
		  const char *format, struct render_options *options, struct sweep_texts *texts, enum exit_code *code)
{
	struct given given = {.format = format};
	int option, index = 0;
	while ((option = getopt_long(argc, argv, "ho:", long_options, &index)) != -1) {
		char whole[256];
		snprintf(whole, sizeof(whole), "%s", optarg ? optarg : "");
		if ((option >= OPTION_CONNECT && option <= OPTION_HELP) || option == 'h') {
			if (!cli_common_option(cli, self, option, code))
				return false;
		} else if (option == '?') {
			return cli_common_option(cli, self, option, code);
		} else if (texts && take_sweep_option(option, optarg, texts)) {
			continue;
		} else if (!take_flag(option, options, &given) && !take_option(option, optarg, options, &given)) {
			_Static_assert(LIMIT_EDIT_LIGHTS == LIMIT_EDIT_MATERIALS && LIMIT_EDIT_LIGHTS == LIMIT_EDIT_NODES,
				       "one sentence for all");
			*code = options->edits.full
				    ? cli_usage(self, "--%s is taken %u times at most: a request has no room for more",
						long_options[index].name, LIMIT_EDIT_LIGHTS)
				    : cli_usage(self, "--%s cannot be \"%s\": it takes %s",
						option == OPTION_OUTPUT ? "output" : long_options[index].name,
						given.word ? given.word : whole, form_of(option));
			return false;
		}
	}
	if (options->edits.given)
		options->request.edits = &options->edits.edits;
	settle_samples(&options->request);
	const char *wrong = NULL;
	if (argc - optind != 1)
		wrong = "one scene is needed";
	else if (!options->output)
		wrong = "-o OUTPUT is missing";
	else
		wrong = settle_format(options, &given);
	if (!wrong)
		wrong = find_idle(options, &given);
	if (wrong)
		*code = cli_usage(self, "%s", wrong);
	else
		options->scene = argv[optind];
	return !wrong;
}

bool render_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			  enum exit_code *code)
{
	init(options);
	return parse(cli, self, argc, argv, render_table, NULL, options, NULL, code);
}

bool sweep_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 struct sweep_texts *texts, enum exit_code *code)
{
	*texts = (struct sweep_texts){0};
	init(options);
	return parse(cli, self, argc, argv, sweep_table, NULL, options, texts, code);
}

bool inspect_options_parse(struct cli *cli, const struct command *self, int argc, char **argv,
			   struct render_options *options, enum exit_code *code)
{
	init(options);
	options->request.samples = 1;
	if (!parse(cli, self, argc, argv, inspect_table, "png", options, NULL, code))
		return false;
	if (options->request.technique == CANDIL_TECHNIQUE_AUTO)
		options->request.technique = CANDIL_TECHNIQUE_VCT;
	return true;
}
