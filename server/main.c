// candild: the front of the service.
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/base/log.h"
#include "server/front/service.h"

// Connections, images and scenes each take a descriptor; the usual soft limit of 1024 is below their sum.
static void raise_descriptor_limit(void)
{
	struct rlimit limit;
	const rlim_t wanted = 8192;
	if (getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted)
		return;
	limit.rlim_cur = limit.rlim_max < wanted ? limit.rlim_max : wanted;
	setrlimit(RLIMIT_NOFILE, &limit);
}

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
	raise_descriptor_limit();
	if (service_run(&options, &err) != STATUS_OK) {
		log_line(LOG_ERROR, "%s", err.text);
		return EXIT_FAILURE;
	}
	return EXIT_SUCCESS;
}
