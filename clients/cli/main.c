// candil, the command line: finds the command and runs it.
#include "clients/cli/cli.h"

#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#define X(name) &name##_command,
static const struct command *const commands[] = {CLI_COMMANDS(X)};
#undef X

static enum exit_code print_help(void)
{
	puts("Usage: candil [--connect ADDR] COMMAND [--json] …\n"
	     "       candil help [COMMAND] | COMMAND --help | --version\n\n"
	     "Asks candild, the render daemon, for pictures of scenes.\n\n"
	     "Commands:");
	for (size_t i = 0; i < sizeof(commands) / sizeof(commands[0]); i++)
		printf("  %-9s %s\n", commands[i]->name, commands[i]->summary);
	printf("\nADDR is a socket's path; without it, $XDG_RUNTIME_DIR/candil.sock.\n"
	       "Every command takes --json: one JSON object on standard output, also on failure ({\"error\": {\"code\",\n"
	       "\"name\", \"message\"}, \"exit\"}), wrong command lines aside. Keys stay as they are; new ones may come.\n"
	       "Keys that end in _us are microseconds; lengths are metres.\n\n%s",
	       cli_exit_codes);
	return cli_flush(stdout, EXIT_DONE);
}

static const struct command *find_command(const char *name)
{
	for (size_t i = 0; i < sizeof(commands) / sizeof(commands[0]); i++) {
		if (strcmp(commands[i]->name, name) == 0)
			return commands[i];
	}
	return NULL;
}

static enum exit_code no_such_command(const char *name)
{
	fprintf(stderr, "candil: there is no command \"%s\"; see candil --help\n", name);
	return EXIT_USAGE;
}

// candil help [COMMAND]
static enum exit_code run_help(int argc, char **argv)
{
	if (argc == 1)
		return print_help();
	const struct command *command = find_command(argv[1]);
	return command ? cli_help(command) : no_such_command(argv[1]);
}

// Started with a standard stream closed, a file that is opened later would get its number, and the answer would be printed
// into a picture. What stands in for it can be used as little as the closed one.
static bool fill_standard_descriptors(void)
{
	for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
		if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0)
			return false;
	return true;
}

int main(int argc, char **argv)
{
	static char program[] = "candil";
	static const struct option options[] = {
	    {"connect", required_argument, NULL, OPTION_CONNECT},
	    {"json", no_argument, NULL, OPTION_JSON},
	    {"help", no_argument, NULL, 'h'},
	    {"version", no_argument, NULL, 'V'},
	    {NULL, 0, NULL, 0},
	};
	struct cli cli = {0};
	int option;
	if (!fill_standard_descriptors())
		return EXIT_OTHER; // and no place to say it
	signal(SIGXFSZ, SIG_IGN); // a file that may not become so large has an error of its own
	if (argc > 0)
		argv[0] = program; // getopt_long puts it before its sentences
	while ((option = getopt_long(argc, argv, "+hV", options, NULL)) != -1) {
		switch (option) {
		case OPTION_CONNECT:
			cli.address = optarg;
			break;
		case OPTION_JSON:
			cli.json = true;
			break;
		case 'h':
			return (int)print_help();
		case 'V':
			printf("candil %s\n", CANDIL_VERSION_STRING);
			return (int)cli_flush(stdout, EXIT_DONE);
		default:
			fputs("candil: see candil --help\n", stderr);
			return EXIT_USAGE;
		}
	}
	if (optind == argc) {
		fputs("candil: a command is missing; see candil --help\n", stderr);
		return EXIT_USAGE;
	}
	int first = optind;
	if (strcmp(argv[first], "help") == 0)
		return (int)run_help(argc - first, argv + first);
	const struct command *command = find_command(argv[first]);
	if (!command)
		return (int)no_such_command(argv[first]);
	argv[first] = program;
	optind = 0; // makes getopt_long begin again with what follows the command
	return (int)command->run(&cli, command, argc - first, argv + first);
}
