#include "clients/cli/cli.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/words.h"

#define HELP_INDENT 24u // where the second column of a help text begins

const char cli_exit_codes[] =
    "Exit codes:\n"
    "  0  done: the image is written, the answer printed\n"
    "  1  anything else, an output that cannot be written among it\n"
    "  2  usage: the command line, or a request that the daemon refuses as wrong, too large or unsupported\n"
    "  3  cannot connect, or the connection was lost\n"
    "  4  the scene: not found, not readable, refused\n"
    "  5  the device: none that is usable, or it failed\n"
    "  6  memory: the job does not fit, or a limit (ulimit -v) leaves too little\n"
    "  7  the deadline of --time passed: the best picture by then is written, if there was one\n"
    "  8  cancelled (Ctrl-C)\n"
    "  9  the worker process was lost, and the retry too\n";

enum exit_code cli_help(const struct command *self)
{
	words_print(stdout, self->help, HELP_INDENT);
	return cli_flush(stdout, EXIT_DONE);
}

bool cli_common_option(struct cli *cli, const struct command *self, int option, enum exit_code *code)
{
	switch (option) {
	case OPTION_CONNECT:
		cli->address = optarg;
		return true;
	case OPTION_JSON:
		cli->json = true;
		return true;
	case OPTION_HELP:
	case 'h':
		*code = cli_help(self);
		return false;
	default:
		// getopt_long has printed what is wrong.
		fprintf(stderr, "candil: see candil %s --help\n", self->name);
		*code = EXIT_USAGE;
		return false;
	}
}

bool cli_parse_simple(struct cli *cli, const struct command *self, int argc, char **argv, int count, enum exit_code *code)
{
	static const struct option options[] = {CLI_COMMON_OPTIONS, {NULL, 0, NULL, 0}};
	int option;
	while ((option = getopt_long(argc, argv, "h", options, NULL)) != -1) {
		if (!cli_common_option(cli, self, option, code))
			return false;
	}
	if (argc - optind == count)
		return true;
	*code = cli_usage(self, argc - optind < count ? "an argument is missing" : "\"%s\" is one argument too many",
			  argv[argc - 1]);
	return false;
}

enum exit_code cli_usage(const struct command *self, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	fputs("candil: ", stderr);
	vfprintf(stderr, format, args);
	fprintf(stderr, "; see candil %s --help\n", self->name);
	va_end(args);
	return EXIT_USAGE;
}

enum exit_code cli_exit_code(candil_status status)
{
	switch (status) {
	case CANDIL_STATUS_OK:
		return EXIT_DONE;
	case CANDIL_STATUS_BAD_ARGUMENT:
	case CANDIL_STATUS_LIMIT:
	case CANDIL_STATUS_UNSUPPORTED:
		return EXIT_USAGE;
	case CANDIL_STATUS_BAD_MAGIC:
	case CANDIL_STATUS_BAD_VERSION:
	case CANDIL_STATUS_BAD_FLAGS:
	case CANDIL_STATUS_NOT_ALLOWED:
	case CANDIL_STATUS_TOO_MANY_CONNECTIONS:
	case CANDIL_STATUS_SHUTTING_DOWN:
	case CANDIL_STATUS_CONNECT:
	case CANDIL_STATUS_IO:
		return EXIT_CONNECT;
	case CANDIL_STATUS_SCENE_NOT_FOUND:
	case CANDIL_STATUS_SCENE_FILE:
	case CANDIL_STATUS_SCENE_PATH:
	case CANDIL_STATUS_SCENE_INVALID:
	case CANDIL_STATUS_SCENE_UNSUPPORTED:
	case CANDIL_STATUS_SCENE_LIMIT:
	case CANDIL_STATUS_LOADER_LOST:
	case CANDIL_STATUS_TOO_MANY_SCENES:
	case CANDIL_STATUS_SCENE_QUARANTINED:
		return EXIT_SCENE;
	case CANDIL_STATUS_DEVICE:
	case CANDIL_STATUS_TRAVERSAL_CUT:
		return EXIT_DEVICE;
	case CANDIL_STATUS_MEMORY:
		return EXIT_MEMORY;
	case CANDIL_STATUS_DEADLINE:
		return EXIT_DEADLINE;
	case CANDIL_STATUS_CANCELLED:
		return EXIT_CANCELLED;
	case CANDIL_STATUS_WORKER_LOST:
		return EXIT_WORKER;
	default:
		return EXIT_OTHER;
	}
}

static enum exit_code say_failure(const struct cli *cli, const struct candil_error *error, enum exit_code code,
				  FILE *json_stream)
{
	fprintf(stderr, "candil: %s (%s)\n", error->text, candil_status_name(error->code));
	if (cli->json)
		cli_print_json(json_pack("{s:{s:i,s:s,s:o},s:i}", "error", "code", (int)error->code, "name",
					 candil_status_name(error->code), "message", cli_json_text(error->text), "exit",
					 (int)code),
			       json_stream, code);
	return code;
}

enum exit_code cli_fail(const struct cli *cli, const struct candil_error *error, FILE *json_stream)
{
	return say_failure(cli, error, cli_exit_code(error->code), json_stream);
}

enum exit_code cli_fail_errno(const struct cli *cli, const char *what, FILE *json_stream)
{
	struct candil_error error = {.code = CANDIL_STATUS_IO};
	const char *why = strerror(errno);
	snprintf(error.text, sizeof(error.text), "%.180s: %s", what, why);
	return say_failure(cli, &error, EXIT_OTHER, json_stream);
}

candil_client *cli_connect(const struct cli *cli, enum exit_code *code)
{
	struct candil_error error;
	candil_client *client;
	if (candil_connect(cli->address, &client, &error) == CANDIL_STATUS_OK)
		return client;
	*code = cli_fail(cli, &error, stdout);
	return NULL;
}

enum exit_code cli_ask(struct cli *cli, const struct command *self, int argc, char **argv, int count,
		       enum exit_code (*ask)(const struct cli *cli, candil_client *client, const char *argument))
{
	enum exit_code code = EXIT_DONE;
	if (!cli_parse_simple(cli, self, argc, argv, count, &code))
		return code;
	candil_client *client = cli_connect(cli, &code);
	if (!client)
		return code;
	code = ask(cli, client, count > 0 ? argv[optind] : NULL);
	candil_disconnect(client);
	return code;
}

bool cli_parse_u64(const char *text, uint64_t *out)
{
	char *end;
	if (!isdigit((unsigned char)text[0]))
		return false;
	errno = 0;
	unsigned long long value = strtoull(text, &end, 10);
	if (errno != 0 || *end != '\0')
		return false;
	*out = value;
	return true;
}

bool cli_parse_u32(const char *text, uint32_t *out)
{
	uint64_t value;
	if (!cli_parse_u64(text, &value) || value > UINT32_MAX)
		return false;
	*out = (uint32_t)value;
	return true;
}

// Read the decimal number at *text and move *text behind it.
static bool take_double(const char **text, double *out)
{
	char *end;
	if (isspace((unsigned char)**text))
		return false;
	double value = strtod(*text, &end);
	if (end == *text || !isfinite(value))
		return false;
	*text = end;
	*out = value;
	return true;
}

bool cli_parse_pair(const char *text, char between, uint32_t *first, uint32_t *second)
{
	char number[16];
	const char *at = strchr(text, between);
	if (!at || (size_t)(at - text) >= sizeof(number))
		return false;
	memcpy(number, text, (size_t)(at - text));
	number[at - text] = '\0';
	return cli_parse_u32(number, first) && cli_parse_u32(at + 1, second);
}

bool cli_parse_doubles(const char *text, double *out, size_t count)
{
	double values[16];
	if (count > 16)
		return false;
	for (size_t i = 0; i < count; i++) {
		if (i > 0 && *text++ != ',')
			return false;
		if (!take_double(&text, &values[i]))
			return false;
	}
	if (*text != '\0')
		return false;
	memcpy(out, values, count * sizeof(*out));
	return true;
}

bool cli_parse_double(const char *text, double *out)
{
	return cli_parse_doubles(text, out, 1);
}

json_t *cli_json_text(const char *text)
{
	json_t *string = json_string(text);
	if (string)
		return string;
	char *plain = strdup(text);
	for (char *c = plain; plain && *c; c++)
		*c = (unsigned char)*c < 0x80 ? *c : '?';
	string = plain ? json_string(plain) : json_null();
	free(plain);
	return string;
}

json_t *cli_json_u64(uint64_t value)
{
	return json_integer((json_int_t)(value > INT64_MAX ? INT64_MAX : value));
}

json_t *cli_json_vec3(const struct candil_vec3 *v)
{
	// json_real refuses a number that is not finite, and a scene without bounds has such numbers.
	if (!isfinite(v->x) || !isfinite(v->y) || !isfinite(v->z))
		return json_null();
	return json_pack("[f,f,f]", v->x, v->y, v->z);
}

enum exit_code cli_flush(FILE *stream, enum exit_code code)
{
	if (fflush(stream) == 0 && !ferror(stream))
		return code;
	fprintf(stderr, "candil: cannot write the answer: %s\n", strerror(errno));
	return code == EXIT_DONE ? EXIT_OTHER : code;
}

enum exit_code cli_print_json(json_t *object, FILE *stream, enum exit_code code)
{
	if (!object) {
		fputs("candil: out of memory for the answer\n", stderr);
		return code == EXIT_DONE ? EXIT_OTHER : code;
	}
	json_dumpf(object, stream, JSON_INDENT(2));
	fputc('\n', stream);
	json_decref(object);
	return cli_flush(stream, code);
}
