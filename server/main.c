// candild: the front of the service.
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

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

int main(int argc, char *argv[])
{
	static struct options options;
	struct error err;
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
