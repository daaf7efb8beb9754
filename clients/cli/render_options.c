#include "clients/cli/render_options.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "clients/cli/render_values.h"
#include "clients/cli/scene_options.h"
#include "clients/cli/words.h"
#include "protocol/limits.h"
#include "protocol/names.h"

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
	OPTION_WHOLE,
	OPTION_FILTER,
	OPTION_LENS,
	OPTION_ORTHOGRAPHIC,
	OPTION_PANORAMA,
	OPTION_NO_DEFAULT_LIGHT,
	OPTION_PILOT,
	OPTION_TECHNIQUES,
	OPTION_BUDGET,
	OPTION_QUICK,
	OPTION_PLAN,
	OPTION_SEEDS,
};

// Which commands have an option: bits.
#define BY_RENDER 1u
#define BY_SWEEP 2u
#define BY_INSPECT 4u
#define BY_QUOTE 8u
#define BY_STUDY 16u
#define BY_ALL (BY_RENDER | BY_SWEEP | BY_INSPECT | BY_QUOTE)
#define BY_EACH (BY_ALL | BY_STUDY)

// The options of this file, one a line: its name, its number, who has it, and what it takes, as a refusal says it, with the
// marks of words.h. NULL: it takes nothing. What is wrong with the
// options of a sweep or a study alone is refused by sweep.c and study_options.c.
// clang-format off
static const struct row {
	const char *name;
	int option;
	unsigned commands;
	const char *form;
} rows[] = {
	{"output", OPTION_OUTPUT, BY_EACH, "a file name, or - for standard output"},
	{"format", OPTION_FORMAT, BY_ALL, "exr, png, ply or mtx"},
	{"technique", OPTION_TECHNIQUE, BY_ALL, "auto, {techniques}"},
	{"size", OPTION_SIZE, BY_EACH, "WxH, two whole numbers of pixels such as 640x480"},
	{"spp", OPTION_SPP, BY_ALL, "a whole number from 1 to 16777216"},
	{"first-sample", OPTION_FIRST_SAMPLE, BY_ALL, "a whole number from 0 to 16777215"},
	{"seed", OPTION_SEED, BY_ALL, "a whole number from 0 on"},
	{"background", OPTION_BACKGROUND, BY_EACH, "r,g,b, three numbers such as 1,1,1, or a picture: its name or its file"},
	{"background-turn", OPTION_BACKGROUND_TURN, BY_EACH, "a number of degrees"},
	{"background-scale", OPTION_BACKGROUND_SCALE, BY_EACH, "a number above 0"},
	{"no-default-light", OPTION_NO_DEFAULT_LIGHT, BY_RENDER | BY_SWEEP | BY_QUOTE | BY_STUDY, NULL},
	{"effects", OPTION_EFFECTS, BY_EACH, "auto, all or none, then +NAME or -NAME, between commas; a NAME is {effects}"},
	{"aov", OPTION_AOV, BY_ALL, "depth, normal, albedo and id, between commas"},
	{"exposure", OPTION_EXPOSURE, BY_ALL, "a number of stops such as -1.5"},
	{"view", OPTION_VIEW, BY_ALL, "none, reinhard or filmic"},
	{"half", OPTION_HALF, BY_ALL, NULL},
	{"float", OPTION_FLOAT, BY_ALL, NULL},
	{"set", OPTION_SET, BY_ALL, "NAME=VALUE such as " TECHNIQUE_OPTION_EXAMPLE ", up to 16 times"},
	{"camera", OPTION_CAMERA, BY_EACH, "the name of a camera, or ten numbers: ex,ey,ez,tx,ty,tz,ux,uy,uz,VFOV"},
	{"error", OPTION_ERROR, BY_ALL, "a relative MSE above 0 such as 1e-3"},
	{"time", OPTION_TIME, BY_ALL, "a whole number of milliseconds from 1 to 86400000"},
	{"whole", OPTION_WHOLE, BY_ALL, NULL},
	{"filter", OPTION_FILTER, BY_EACH, "box, gauss or bh"},
	{"lens", OPTION_LENS, BY_EACH, "RADIUS,FOCUS, two lengths in metres such as 0.02,3.5"},
	{"orthographic", OPTION_ORTHOGRAPHIC, BY_EACH, "the height of the picture in metres, above 0"},
	{"panorama", OPTION_PANORAMA, BY_EACH, NULL},
	{"quiet", OPTION_QUIET, BY_EACH, NULL},
	{"progressive", OPTION_PROGRESSIVE, BY_RENDER, NULL},
	{"pilot", OPTION_PILOT, BY_QUOTE, "a whole number of milliseconds from 1 to 60000"},
	{"at", OPTION_AT, BY_RENDER | BY_INSPECT | BY_QUOTE | BY_STUDY, "a number of seconds"},
	{"orbit", OPTION_ORBIT, BY_SWEEP, ""},
	{"cameras", OPTION_CAMERAS, BY_SWEEP, ""},
	{"shard", OPTION_SHARD, BY_SWEEP, ""},
	{"keys", OPTION_KEYS, BY_SWEEP, ""},
	{"frames", OPTION_FRAMES, BY_SWEEP, ""},
	{"fps", OPTION_FPS, BY_SWEEP, ""},
	{"force", OPTION_FORCE, BY_SWEEP, NULL},
	{"techniques", OPTION_TECHNIQUES, BY_STUDY, ""},
	{"budget", OPTION_BUDGET, BY_STUDY, ""},
	{"quick", OPTION_QUICK, BY_STUDY, NULL},
	{"plan", OPTION_PLAN, BY_STUDY, ""},
	{"seeds", OPTION_SEEDS, BY_STUDY, ""},
};
// clang-format on
#define ROWS (sizeof(rows) / sizeof(rows[0]))

// The options that other files define.
static const struct option shared_options[] = {CLI_COMMON_OPTIONS, SCENE_OPTIONS, EDIT_OPTIONS};
#define SHARED (sizeof(shared_options) / sizeof(shared_options[0]))

// getopt_long's table of a command.
static void list_options(unsigned command, struct option out[SHARED + ROWS + 1])
{
	size_t count = SHARED;
	memcpy(out, shared_options, sizeof(shared_options));
	for (size_t i = 0; i < ROWS; i++)
		if (rows[i].commands & command)
			out[count++] = (struct option){rows[i].name, rows[i].form ? required_argument : no_argument, NULL,
						       rows[i].option};
	out[count] = (struct option){0};
}

// What --format and an output's extension name.
enum { FORMAT_EXR, FORMAT_PNG, FORMAT_PLY, FORMAT_MTX, FORMATS };

// FORMATS: none has this name.
static size_t find_format(const char *name)
{
	static const char *const names[FORMATS] = {"exr", "png", "ply", "mtx"};
	size_t i = 0;
	while (i < FORMATS && strcasecmp(name, names[i]) != 0)
		i++;
	return i;
}

// What was given on the command line and must fit together.
struct given {
	const char *format;
	bool half, single, exposure, view, turn, scale, orthographic, panorama;
	const char *word; // the wrong word of a list
};

// What an option takes, for a sentence.
static const char *form_of(int option)
{
	for (size_t i = 0; i < ROWS; i++)
		if (rows[i].option == option)
			return rows[i].form;
	return edit_is_option(option) ? edit_option_form(option) : scene_option_form(option);
}

// "--size cannot be "5": it takes …"
static enum exit_code refuse_value(const struct command *self, const char *name, const char *value, const char *form)
{
	char *filled = words_text(form);
	const enum exit_code code =
	    cli_usage(self, "--%s cannot be \"%s\": it takes %s", name, value, filled ? filled : form);
	free(filled);
	return code;
}

// A file that is imported is set as an option, and is none: it is loaded first.
static bool parse_setting(char *text, struct render_options *options)
{
	static const char import[] = TECHNIQUE_OPTION_IMPORT "=";
	if (!strncmp(text, import, sizeof(import) - 1)) {
		const bool first = !options->request.imported;
		options->request.imported = text + sizeof(import) - 1;
		return first && *options->request.imported;
	}
	char *equals = strchr(text, '=');
	size_t room = sizeof(options->settings) / sizeof(options->settings[0]);
	if (!equals || equals == text || equals[1] == '\0' || options->request.option_count == room)
		return false;
	*equals = '\0';
	options->settings[options->request.option_count++] = (struct candil_option){text, equals + 1};
	return true;
}

// Take one option with its value. false: the value is wrong.
static bool take_option(int option, char *value, struct render_options *options, struct given *given)
{
	struct candil_render_request *r = &options->request;
	switch (option) {
	case OPTION_OUTPUT:
		options->output = value;
		return *value != '\0';
	case OPTION_FORMAT:
		given->format = value;
		return find_format(value) < FORMATS;
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
	case OPTION_PILOT:
		return cli_parse_u32(value, &options->pilot_ms) && options->pilot_ms > 0 &&
		       options->pilot_ms <= LIMIT_PILOT_MS;
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
	case OPTION_WHOLE:
		options->request.whole = true;
		return true;
	case OPTION_NO_DEFAULT_LIGHT:
		options->request.default_light = false;
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

// Take an option that only a sweep has. false: it is another option.
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

// Hand an option to the one who wants to see it before it is taken: a study. false: it is not for this file.
static bool is_left(const struct option_watch *watch, const struct option *option, const char *value)
{
	return watch && watch->take(watch->user, option->name, value);
}

// The number of the format that is asked for; FORMATS: the output's name ends in none.
static size_t format_of(const struct render_options *options, const struct given *given)
{
	if (given->format)
		return find_format(given->format);
	if (!options->output)
		return FORMAT_EXR;
	if (strcmp(options->output, "-") == 0)
		return FORMAT_PNG;
	const char *dot = strrchr(options->output, '.');
	return dot ? find_format(dot + 1) : FORMATS;
}

// Set the format of the file. Returns the sentence that says what does not fit together, or NULL.
static const char *settle_format(struct render_options *options, const struct given *given, unsigned which)
{
	static const enum candil_format formats[FORMATS] = {CANDIL_FORMAT_EXR_FLOAT, CANDIL_FORMAT_PNG, CANDIL_FORMAT_PLY,
							    CANDIL_FORMAT_MTX};
	const size_t format = format_of(options, given);
	if (format == FORMATS)
		return "the output's name ends in none of .exr, .png, .ply, .mtx; say --format exr or --format png";
	if (given->half && given->single)
		return "--half and --float exclude each other";
	options->request.format = format == FORMAT_EXR && given->half ? CANDIL_FORMAT_EXR_HALF : formats[format];
	if (format == FORMAT_EXR)
		return given->exposure || given->view ? "an EXR holds linear radiance: --exposure and --view are for PNG"
						      : NULL;
	if (given->half || given->single)
		return "--half and --float are for EXR";
	if (options->request.aovs)
		return "--aov needs EXR output";
	if (format == FORMAT_PNG)
		return NULL;
	if (which != BY_RENDER)
		return "ply and mtx are no pictures: candil render makes them, and candil inspect beside its pictures";
	if (options->request.progressive || options->request.deadline_ms > 0)
		return "a file of patches comes whole, when it is ready: leave --progressive and --time out";
	if (options->request.technique == CANDIL_TECHNIQUE_AUTO)
		options->request.technique = (enum candil_technique)technique_with(TECHNIQUE_PATCHES);
	return given->exposure || given->view ? "--exposure and --view are for PNG" : NULL;
}

// Returns the sentence that says which option would do nothing, or NULL.
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

// Set the samples of a sweep without --spp to the daemon's default. A sweep must know the number, because it bounds how many
// cameras go into one request. A technique without noise needs one sample. Where an error or a deadline ends the render, the
// number is more than any picture needs.
static void settle_samples(struct candil_render_request *request)
{
	struct candil_render_request usual;
	candil_render_request_init(&usual);
	const bool noisy = technique_traits((unsigned)request->technique) & TECHNIQUE_NOISE;
	const bool open = request->target_error > 0 || request->deadline_ms > 0;
	if (request->samples == 0)
		request->samples = noisy && open ? OPEN_SAMPLES : noisy ? usual.samples : 1;
}

static void options_init(struct render_options *options)
{
	memset(options, 0, sizeof(*options));
	candil_render_request_init(&options->request);
	options->request.samples = 0;
	options->request.options = options->settings;
	edit_options_init(&options->edits);
}

// Parse into options that options_init began. `which`: one of BY_…. `format`: that of an output whose name has no extension;
// NULL: the name must have one. `texts`: NULL but for a sweep. `watch`: NULL but for a study.
static bool options_parse(struct cli *cli, const struct command *self, int argc, char **argv, unsigned which,
			  const char *format, struct render_options *options, struct sweep_texts *texts,
			  const struct option_watch *watch, enum exit_code *code)
{
	struct given given = {.format = format};
	struct option long_options[SHARED + ROWS + 1];
	const struct option output = {"output", required_argument, NULL, OPTION_OUTPUT};
	int option, index = 0;
	list_options(which, long_options);
	while ((option = getopt_long(argc, argv, "ho:", long_options, &index)) != -1) {
		char whole[256];
		snprintf(whole, sizeof(whole), "%s", optarg ? optarg : "");
		if ((option >= OPTION_CONNECT && option <= OPTION_HELP) || option == 'h') {
			if (!cli_common_option(cli, self, option, code))
				return false;
		} else if (option == '?') {
			return cli_common_option(cli, self, option, code);
		} else if ((texts && take_sweep_option(option, optarg, texts)) ||
			   is_left(watch, option == OPTION_OUTPUT ? &output : &long_options[index], optarg)) {
			continue;
		} else if (!take_flag(option, options, &given) && !take_option(option, optarg, options, &given)) {
			_Static_assert(LIMIT_EDIT_LIGHTS == LIMIT_EDIT_MATERIALS && LIMIT_EDIT_LIGHTS == LIMIT_EDIT_NODES,
				       "one sentence for all");
			*code = options->edits.full
				    ? cli_usage(self, "--%s is taken %u times at most: a request has no room for more",
						long_options[index].name, LIMIT_EDIT_LIGHTS)
				    : refuse_value(self, option == OPTION_OUTPUT ? "output" : long_options[index].name,
						   given.word ? given.word : whole, form_of(option));
			return false;
		}
	}
	if (options->edits.given)
		options->request.edits = &options->edits.edits;
	if (texts)
		settle_samples(&options->request);
	const char *wrong = NULL;
	if (argc - optind != 1)
		wrong = "one scene is needed";
	else if (!options->output && which != BY_QUOTE)
		wrong = "-o OUTPUT is missing";
	else
		wrong = settle_format(options, &given, which);
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
	options_init(options);
	options->request.default_light = true;
	return options_parse(cli, self, argc, argv, BY_RENDER, NULL, options, NULL, NULL, code);
}

bool sweep_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 struct sweep_texts *texts, enum exit_code *code)
{
	*texts = (struct sweep_texts){0};
	options_init(options);
	options->request.default_light = true;
	return options_parse(cli, self, argc, argv, BY_SWEEP, NULL, options, texts, NULL, code);
}

bool inspect_options_parse(struct cli *cli, const struct command *self, int argc, char **argv,
			   struct render_options *options, enum exit_code *code)
{
	options_init(options);
	options->request.samples = 1;
	if (!options_parse(cli, self, argc, argv, BY_INSPECT, "png", options, NULL, NULL, code))
		return false;
	if (options->request.technique == CANDIL_TECHNIQUE_AUTO)
		options->request.technique = (enum candil_technique)technique_with(TECHNIQUE_VOXELS);
	return true;
}

bool quote_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 enum exit_code *code)
{
	options_init(options);
	options->request.default_light = true;
	return options_parse(cli, self, argc, argv, BY_QUOTE, NULL, options, NULL, NULL, code);
}

bool study_options_parse(struct cli *cli, const struct command *self, int argc, char **argv, struct render_options *options,
			 const struct option_watch *watch, enum exit_code *code)
{
	options_init(options);
	options->request.default_light = true;
	return options_parse(cli, self, argc, argv, BY_STUDY, "exr", options, NULL, watch, code);
}
