#include "server/front/options.h"

#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "protocol/text.h"

#define DEFAULT_SLICE_MS 50u
#define SECONDS_MAX 86400u
#define MEMORY_BUDGET_MAX_MIB (1u << 24)

enum option_id {
	SOCKET = 256,
	SCENE,
	WARM,
	SCENE_ROOT,
	DEVICE,
	REQUIRE_GPU,
	MEMORY_BUDGET,
	SLICE,
	HANG,
	ANSWER,
	LIBEXEC,
	PRIVATE_FD,
	STATE,
	NO_STATE,
	VERSION,
	HELP = 'h'
};

static const struct option long_options[] = {
    {"socket", required_argument, NULL, SOCKET},
    {"scene", required_argument, NULL, SCENE},
    {"warm", required_argument, NULL, WARM},
    {"scene-root", required_argument, NULL, SCENE_ROOT},
    {"device", required_argument, NULL, DEVICE},
    {"require-gpu", no_argument, NULL, REQUIRE_GPU},
    {"memory-budget", required_argument, NULL, MEMORY_BUDGET},
    {"slice", required_argument, NULL, SLICE},
    {"hang", required_argument, NULL, HANG},
    {"answer", required_argument, NULL, ANSWER},
    {"libexec", required_argument, NULL, LIBEXEC},
    {"private-fd", required_argument, NULL, PRIVATE_FD},
    {"state", required_argument, NULL, STATE},
    {"no-state", no_argument, NULL, NO_STATE},
    {"help", no_argument, NULL, HELP},
    {"version", no_argument, NULL, VERSION},
    {NULL, 0, NULL, 0},
};

const char *options_help(void)
{
	return "candild: renders scenes for clients of its socket\n"
	       "\n"
	       "  --socket PATH        listen here (default $XDG_RUNTIME_DIR/candil.sock)\n"
	       "  --scene NAME=FILE    load FILE at start and keep it as NAME; may be repeated. If one cannot be loaded,\n"
	       "                       the daemon says why and ends with status 1\n"
	       "  --warm NAME=FILE     the same, and listen only when one picture of it by each technique has been "
	       "rendered:\n"
	       "                       the first client finds shaders compiled and voxels built\n"
	       "  --scene-root DIR     clients may load files beneath DIR by path\n"
	       "  --device WHICH       a device's number or UUID, or cpu (default: the best there is)\n"
	       "  --require-gpu        refuse to render on a software device\n"
	       "  --memory-budget MIB  device memory that the worker may use (default: its choice); processes that compile "
	       "may\n"
	       "                       together have once more what it left of that as they started\n"
	       "  --slice MS           length of a slice of device time, 1 to 1000 (default 50)\n"
	       "  --hang SECONDS       a loader or worker that for so long neither works nor waits for a processor or a\n"
	       "                       disk hangs, and is killed (default 30; of a worker on a GPU 120)\n"
	       "  --answer SECONDS     so does a worker that has worked on one order for so long (default 300; what waits\n"
	       "                       for a processor does not count, and several threads count as one)\n"
	       "  --libexec DIR        where candil-loader and candil-worker are\n"
	       "  --state DIR          keep there what is learned of times and errors, for quotes (default\n"
	       "                       $XDG_STATE_HOME/candil, or ~/.local/state/candil)\n"
	       "  --no-state           keep nothing\n"
	       "  --private-fd N       serve the connected socket N alone and exit when it closes\n"
	       "  -h, --help, --version\n"
	       "\n"
	       "$CANDIL_LOG = error, warning, info or debug sets how much is written to standard error.\n";
}

static enum status parse_number(const char *text, const char *option, uint32_t least, uint32_t most, uint32_t *out,
				struct error *err)
{
	size_t digits = strspn(text, "0123456789");
	unsigned long value = strtoul(text, NULL, 10);
	if (digits == 0 || digits > 9 || text[digits] || value < least || value > most)
		return error_set(err, STATUS_BAD_ARGUMENT, "--%s takes a number from %u to %u, not \"%.40s\"", option, least,
				 most, text);
	*out = (uint32_t)value;
	return STATUS_OK;
}

static enum status copy_path(const char *text, const char *option, char out[PATH_MAX], struct error *err)
{
	size_t length = strlen(text);
	if (length == 0 || length >= PATH_MAX)
		return error_set(err, STATUS_BAD_ARGUMENT, "--%s takes a path", option);
	memcpy(out, text, length + 1);
	return STATUS_OK;
}

static enum status add_scene(struct options *options, const char *text, bool warm, struct error *err)
{
	const char *equals = strchr(text, '=');
	if (options->scene_count == LIMIT_SCENES)
		return error_set(err, STATUS_TOO_MANY_SCENES, "there can be %u scenes at most", LIMIT_SCENES);
	struct scene_option *scene = &options->scenes[options->scene_count];
	size_t length = equals ? (size_t)(equals - text) : 0;
	if (length > 0 && length < sizeof scene->name && equals[1]) {
		memcpy(scene->name, text, length);
		scene->name[length] = 0;
	}
	if (!text_is_name(scene->name))
		return error_set(err, STATUS_BAD_ARGUMENT, "--%s takes NAME=FILE, not \"%.80s\"", warm ? "warm" : "scene",
				 text);
	scene->file = equals + 1;
	scene->warm = warm;
	options->scene_count++;
	return STATUS_OK;
}

static enum status set_private(struct options *options, const char *text, struct error *err)
{
	uint32_t fd = 0;
	enum status status = parse_number(text, "private-fd", 0, 65535, &fd, err);
	if (status == STATUS_OK)
		options->private_fd = (int)fd;
	return status;
}

static enum status set_option(struct options *options, int id, const char *text, struct error *err)
{
	switch ((enum option_id)id) {
	case SOCKET:
		return copy_path(text, "socket", options->socket, err);
	case SCENE:
	case WARM:
		return add_scene(options, text, id == WARM, err);
	case SCENE_ROOT:
		options->scene_root = text;
		return STATUS_OK;
	case DEVICE:
		options->device = text;
		return STATUS_OK;
	case REQUIRE_GPU:
		options->require_gpu = true;
		return STATUS_OK;
	case MEMORY_BUDGET:
		return parse_number(text, "memory-budget", 1, MEMORY_BUDGET_MAX_MIB, &options->memory_budget_mib, err);
	case SLICE:
		return parse_number(text, "slice", 1, LIMIT_SLICE_MS, &options->slice_ms, err);
	case HANG:
		return parse_number(text, "hang", 1, SECONDS_MAX, &options->hang_s, err);
	case ANSWER:
		return parse_number(text, "answer", 1, SECONDS_MAX, &options->answer_s, err);
	case LIBEXEC:
		return copy_path(text, "libexec", options->libexec, err);
	case PRIVATE_FD:
		return set_private(options, text, err);
	case STATE:
		options->no_state = false;
		return copy_path(text, "state", options->state, err);
	case NO_STATE:
		options->no_state = true;
		return STATUS_OK;
	case HELP:
		options->help = true;
		return STATUS_OK;
	case VERSION:
		options->version = true;
		return STATUS_OK;
	}
	return error_set(err, STATUS_BAD_ARGUMENT, "unknown option; candild --help lists them");
}

// Say what was wrong with an option that getopt_long refused. `result` is what it returned, `about` what it left in optopt.
static enum status refuse_option(int result, int about, const char *word, struct error *err)
{
	if (result == ':')
		return error_set(err, STATUS_BAD_ARGUMENT, "%.80s takes a value, and there is none; see candild --help",
				 word);
	if (about >= SOCKET)
		return error_set(err, STATUS_BAD_ARGUMENT, "%.80s: this option takes no value; see candild --help", word);
	return error_set(err, STATUS_BAD_ARGUMENT, "%.80s: there is no such option; see candild --help", word);
}

static enum status default_socket(struct options *options, struct error *err)
{
	const char *folder = getenv("XDG_RUNTIME_DIR");
	if (!folder || folder[0] != '/')
		return error_set(
		    err, STATUS_BAD_ARGUMENT,
		    "$XDG_RUNTIME_DIR is not set: say where to listen with --socket PATH, in a folder of your own");
	int length = snprintf(options->socket, sizeof options->socket, "%s/candil.sock", folder);
	if (length < 0 || (size_t)length >= sizeof options->socket)
		return error_set(err, STATUS_BAD_ARGUMENT, "$XDG_RUNTIME_DIR is too long: give --socket PATH");
	return STATUS_OK;
}

// A folder beneath that of the user's environment. Without one nothing is kept.
static void default_state(struct options *options)
{
	const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
	int length = -1;
	if (state && state[0] == '/')
		length = snprintf(options->state, sizeof options->state, "%s/candil", state);
	else if (home && home[0] == '/')
		length = snprintf(options->state, sizeof options->state, "%s/.local/state/candil", home);
	if (length < 0 || (size_t)length >= sizeof options->state)
		options->state[0] = 0;
}

// The programs that candild starts are in ../libexec/candil, seen from its own folder, in an installed tree and in the
// build's.
static enum status default_libexec(struct options *options, struct error *err)
{
	char self[PATH_MAX];
	ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
	if (length <= 0)
		return error_errno(err, STATUS_INTERNAL, "cannot find this program's folder: give --libexec DIR");
	self[length] = 0;
	*strrchr(self, '/') = 0;
	int written = snprintf(options->libexec, sizeof options->libexec, "%s/../libexec/candil", self);
	if (written < 0 || (size_t)written >= sizeof options->libexec)
		return error_set(err, STATUS_INTERNAL, "this program's path is too long: give --libexec DIR");
	return STATUS_OK;
}

enum status options_parse(struct options *options, int argc, char *const argv[], struct error *err)
{
	memset(options, 0, sizeof *options);
	options->private_fd = -1;
	options->slice_ms = DEFAULT_SLICE_MS;
	options->answer_s = LIMIT_ANSWER_SECONDS;
	enum status status = STATUS_OK;
	optind = 0;
	opterr = 0;
	while (status == STATUS_OK) {
		int id = getopt_long(argc, argv, ":h", long_options, NULL);
		if (id == -1)
			break;
		status = id == '?' || id == ':' ? refuse_option(id, optopt, argv[optind - 1], err)
						: set_option(options, id, optarg, err);
	}
	if (status != STATUS_OK || options->help || options->version)
		return status;
	if (optind < argc)
		return error_set(err, STATUS_BAD_ARGUMENT, "\"%.80s\" is no option; candild --help lists them",
				 argv[optind]);
	if (!options->socket[0] && options->private_fd < 0)
		status = default_socket(options, err);
	if (options->no_state)
		options->state[0] = 0;
	else if (!options->state[0])
		default_state(options);
	if (status == STATUS_OK && !options->libexec[0])
		status = default_libexec(options, err);
	return status;
}
