// candild: the front of the service.
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "server/base/log.h"
#include "server/front/service.h"

// Started with one of them closed, the next socket would get its number, and the log would go to a client.
static bool fill_standard_descriptors(void)
{
	int fd;
	do
		fd = open("/dev/null", O_RDWR);
	while (fd >= 0 && fd <= STDERR_FILENO);
	return fd >= 0 && close(fd) == 0;
}

int main(int argc, char *argv[])
{
	static struct options options;
	struct error err;
	if (!fill_standard_descriptors())
		return EXIT_FAILURE; // and no place to say it
	log_init("candild", LOG_INFO);
	if (options_parse(&options, argc, argv, &err) != STATUS_OK) {
		fprintf(stderr, "candild: %s\n", err.text);
		return 2;
	}
	if (options.help || options.version) {
		fputs(options.help ? options_help() : "candild " CANDIL_VERSION_STRING "\n", stdout);
		return fflush(stdout) == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
	}
	if (service_run(&options, &err) != STATUS_OK) {
		log_line(LOG_ERROR, "%s", err.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}
