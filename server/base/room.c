#include "server/base/room.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

uint64_t room_limit_mib(void)
{
	struct rlimit limit;
	if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
		return 0;
	return (limit.rlim_cur >> 20) + (limit.rlim_cur % (1u << 20) > 0 || limit.rlim_cur == 0); // rounded up: 0 is none
}

bool room_left(uint64_t bytes)
{
	struct rlimit limit;
	char text[64];
	if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
		return true;
	// To try it out by a mapping would take it from other threads for that while.
	const int fd = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
	const ssize_t got = fd >= 0 ? read(fd, text, sizeof text - 1) : -1;
	if (fd >= 0)
		close(fd);
	if (got <= 0)
		return true;
	text[got] = 0;
	const uint64_t has = strtoull(text, NULL, 10) * (uint64_t)sysconf(_SC_PAGESIZE);
	return has < limit.rlim_cur && bytes <= limit.rlim_cur - has;
}

void room_advise(char *sentence, size_t capacity)
{
	const uint64_t limit = room_limit_mib();
	const size_t used = strlen(sentence);
	if (limit > 0 && used < capacity)
		snprintf(sentence + used, capacity - used,
			 ": raise the limit of address space (ulimit -v, LimitAS=), which is %" PRIu64 " MiB", limit);
}
