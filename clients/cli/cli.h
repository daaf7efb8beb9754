// What the commands of `candil` share: exit codes, common options, connecting, printing.
// The program has one thread. The strings of options point into argv.
#ifndef CANDIL_CLI_H
#define CANDIL_CLI_H

#include <getopt.h>
#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "clients/libcandil/candil.h"

enum exit_code {
	EXIT_DONE = 0, // an image was written, an answer printed
	EXIT_OTHER = 1,
	EXIT_USAGE = 2,
	EXIT_CONNECT = 3,
	EXIT_SCENE = 4,
	EXIT_DEVICE = 5,
	EXIT_MEMORY = 6,
	EXIT_DEADLINE = 7, // the best picture that was ready in time is written, if there was one
	EXIT_CANCELLED = 8,
	EXIT_WORKER = 9,
};

// The list of exit codes, for the help of the whole program.
extern const char cli_exit_codes[];

struct cli {
	const char *address; // --connect; NULL: the default socket
	bool json; // --json
};

struct command {
	const char *name;
	const char *summary;
	const char *help; // everything that `candil NAME --help` prints, with the marks of words.h
	enum exit_code (*run)(struct cli *cli, const struct command *self, int argc, char **argv);
};

// Every command, in the order of the help.
#define CLI_COMMANDS(X) \
	X(ping) \
	X(doctor) \
	X(load) \
	X(unload) \
	X(scenes) \
	X(describe) \
	X(render) \
	X(sweep) \
	X(quote) \
	X(study) \
	X(compare) \
	X(inspect) \
	X(stats)

#define X(name) extern const struct command name##_command;
CLI_COMMANDS(X)
#undef X

// The options that every command takes. A command puts them into its own table.
enum { OPTION_CONNECT = 1000, OPTION_JSON, OPTION_HELP };
#define CLI_COMMON_OPTIONS \
	{"connect", required_argument, NULL, OPTION_CONNECT}, {"json", no_argument, NULL, OPTION_JSON}, \
	{ \
		"help", no_argument, NULL, OPTION_HELP \
	}

// Print the command's help.
enum exit_code cli_help(const struct command *self);

// Handle a common option that getopt_long returned. true: go on. false: return *code from the command, because help was
// asked for or the option is wrong.
bool cli_common_option(struct cli *cli, const struct command *self, int option, enum exit_code *code);

// Parse a command line of common options and exactly `count` other arguments. The result is as above.
bool cli_parse_simple(struct cli *cli, const struct command *self, int argc, char **argv, int count, enum exit_code *code);

// Run a command that is one question to the daemon: parse as cli_parse_simple does (count 0 or 1), connect, call `ask`,
// which prints its answer or failure, and disconnect. `argument` is the one of the command line; NULL if count is 0.
enum exit_code cli_ask(struct cli *cli, const struct command *self, int argc, char **argv, int count,
		       enum exit_code (*ask)(const struct cli *cli, candil_client *client, const char *argument));

// Print "candil: …; see candil NAME --help" on standard error. Returns EXIT_USAGE.
enum exit_code cli_usage(const struct command *self, const char *format, ...) __attribute__((format(printf, 2, 3)));

// The exit code of a failure.
enum exit_code cli_exit_code(candil_status status);

// Print a failure: a sentence on standard error, and with --json an object {"error": {"code", "name", "message"}, "exit"} on
// `json_stream`. Returns the exit code.
enum exit_code cli_fail(const struct cli *cli, const struct candil_error *error, FILE *json_stream);

// The same for a failure of this program itself, which errno explains: "what: why". Returns EXIT_OTHER.
enum exit_code cli_fail_errno(const struct cli *cli, const char *what, FILE *json_stream);

// Connect, or print why not: NULL, and the command returns *code.
candil_client *cli_connect(const struct cli *cli, enum exit_code *code);

// Each converts a whole string. false: the string is something else, and *out is left alone.
bool cli_parse_u32(const char *text, uint32_t *out);
bool cli_parse_u64(const char *text, uint64_t *out);
bool cli_parse_double(const char *text, double *out); // finite
// Two numbers with `between` between them: "640x480", "1/4".
bool cli_parse_pair(const char *text, char between, uint32_t *first, uint32_t *second);
// `count` doubles between commas.
bool cli_parse_doubles(const char *text, double *out, size_t count);

// A JSON string. A text that is not UTF-8 gets a '?' for each byte above 127.
json_t *cli_json_text(const char *text);
// The ending of a noun behind a count: "" or "s".
static inline const char *cli_s(uint64_t count)
{
	return count == 1 ? "" : "s";
}

// A JSON integer, at most INT64_MAX; an array of three numbers, null if one is not finite.
json_t *cli_json_u64(uint64_t value);
json_t *cli_json_vec3(const struct candil_vec3 *v);

// Print the object and release it; flush the stream. Both return `code`, or EXIT_OTHER if writing fails (a full disk, a
// closed pipe) after a success.
enum exit_code cli_print_json(json_t *object, FILE *stream, enum exit_code code);
enum exit_code cli_flush(FILE *stream, enum exit_code code);

#endif
