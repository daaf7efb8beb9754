// What the commands of `candil` share: exit codes, common options, connecting, printing.
// One thread. Strings of options point into argv.
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
	EXIT_DEADLINE = 7, // the best picture by then is written, if there was one
	EXIT_CANCELLED = 8,
	EXIT_WORKER = 9,
};

// For --help, of main and of render.
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

extern const struct command ping_command, stats_command, load_command, unload_command, scenes_command, describe_command,
    render_command, sweep_command, inspect_command, compare_command, doctor_command;

// The options that every command takes, to be put into its table, and their handling.
enum { OPTION_CONNECT = 1000, OPTION_JSON, OPTION_HELP };
#define CLI_COMMON_OPTIONS \
	{"connect", required_argument, NULL, OPTION_CONNECT}, {"json", no_argument, NULL, OPTION_JSON}, \
	{ \
		"help", no_argument, NULL, OPTION_HELP \
	}

// Print the command's help.
enum exit_code cli_help(const struct command *self);

// Act on what getopt_long returned. true: go on. false: return *code from the command (help was asked for, or the option
// is wrong).
bool cli_common_option(struct cli *cli, const struct command *self, int option, enum exit_code *code);

// Parse a command line of common options and exactly `count` other arguments. As above.
bool cli_parse_simple(struct cli *cli, const struct command *self, int argc, char **argv, int count, enum exit_code *code);

// A whole command that is one question to the daemon: parse as cli_parse_simple does (count 0 or 1), connect, `ask`, which
// says its answer or failure on standard output, and disconnect. `argument` is that of the command line, NULL without one.
enum exit_code cli_ask(struct cli *cli, const struct command *self, int argc, char **argv, int count,
		       enum exit_code (*ask)(const struct cli *cli, candil_client *client, const char *argument));

// "candil: …" on stderr and EXIT_USAGE.
enum exit_code cli_usage(const struct command *self, const char *format, ...) __attribute__((format(printf, 2, 3)));

enum exit_code cli_exit_code(candil_status status);

// Say a failure: a sentence on stderr, with --json an object {"error":{"code","name","message"},"exit"} on `json_stream`.
enum exit_code cli_fail(const struct cli *cli, const struct candil_error *error, FILE *json_stream);

// The same for trouble on this side, where errno says why: "what: why", EXIT_OTHER.
enum exit_code cli_fail_errno(const struct cli *cli, const char *what, FILE *json_stream);

// Connect, or say why not. NULL on failure, *code is then the command's.
candil_client *cli_connect(const struct cli *cli, enum exit_code *code);

// Whole-string conversions; false leaves *out alone.
bool cli_parse_u32(const char *text, uint32_t *out);
bool cli_parse_u64(const char *text, uint64_t *out);
bool cli_parse_double(const char *text, double *out); // finite
// Two numbers with `between` between them: "640x480", "1/4".
bool cli_parse_pair(const char *text, char between, uint32_t *first, uint32_t *second);
// `count` doubles between commas.
bool cli_parse_doubles(const char *text, double *out, size_t count);

// A JSON string, with '?' for what is no UTF-8.
json_t *cli_json_text(const char *text);
// The ending of a noun behind a count.
static inline const char *cli_s(uint64_t count)
{
	return count == 1 ? "" : "s";
}

json_t *cli_json_u64(uint64_t value);
json_t *cli_json_vec3(const struct candil_vec3 *v);

// Print and release. Writing can fail (a full disk, a closed pipe): EXIT_OTHER then, else `code`.
enum exit_code cli_print_json(json_t *object, FILE *stream, enum exit_code code);
enum exit_code cli_flush(FILE *stream, enum exit_code code);

#endif
