#include "server/front/capacity.h"

#include <dirent.h>
#include <sys/resource.h>
#include <unistd.h>

#include "protocol/limits.h"
#include "server/base/log.h"
#include "server/base/room.h"
#include "server/front/channel.h"

// What the daemon has open of its own, at most, beside what was open when it started.
enum {
	OWN = 4, // epoll, signals, the listener, the scene root
	WORKER = 2, // its socket and its pidfd
	LOADERS = 3 * (LIMIT_LOADERS + 1), // likewise, and the blob that one has sent while its folder is still open
	COMPILERS = 2 * LIMIT_COMPILERS,
	STARTING = 3, // a child: its end of the socket pair, copies of that and of its folder
	RECEIVING = CHANNEL_FDS,
	FILES = 3, // opened for a moment: of what is learned, beneath the scene root, beside the socket
	DAEMONS_OWN =
	    OWN + WORKER + LOADERS + COMPILERS + STARTING + RECEIVING + FILES + LIMIT_CHILDREN_LEFT + LIMIT_TURNED_AWAY,
};

#define A_CONNECTION 3u // socket, folder of a LOAD, an image
#define A_SCENE 2u // one with a name, one that only jobs still use
#define LEAST_CONNECTIONS 4u
#define LEAST_SCENES 2u
#define LEAST_IMAGES 2u

static const struct capacity all = {.connections = LIMIT_CONNECTIONS, .scenes = LIMIT_SCENES, .images = 2 * LIMIT_JOBS};

static unsigned least(unsigned a, unsigned b)
{
	return a < b ? a : b;
}

unsigned capacity_descriptors(const struct capacity *capacity)
{
	return A_CONNECTION * capacity->connections + A_SCENE * capacity->scenes + capacity->images;
}

// Images only wait for each other, so they get what the others leave, and a sixteenth at least.
bool capacity_divide(struct capacity *capacity, unsigned descriptors)
{
	const struct capacity served = {.connections = all.connections, .scenes = all.scenes};
	const unsigned most = capacity_descriptors(&served), images = descriptors / 16;
	if (descriptors < LEAST_SCENES * A_SCENE + LEAST_IMAGES)
		return false;
	const unsigned left = least(most, descriptors - (images > LEAST_IMAGES ? images : LEAST_IMAGES));
	capacity->scenes = left * all.scenes / most;
	if (capacity->scenes < LEAST_SCENES)
		capacity->scenes = LEAST_SCENES;
	capacity->connections = least(all.connections, (left - A_SCENE * capacity->scenes) / A_CONNECTION);
	capacity->images = 0;
	capacity->images = least(all.images, descriptors - capacity_descriptors(capacity));
	return capacity->connections >= LEAST_CONNECTIONS;
}

// Descriptors that the daemon was started with, which it never closes.
static unsigned count_open(void)
{
	unsigned count = 0;
	DIR *folder = opendir("/proc/self/fd");
	if (!folder)
		return STDERR_FILENO + 1;
	for (const struct dirent *entry = readdir(folder); entry; entry = readdir(folder))
		count += entry->d_name[0] != '.';
	closedir(folder);
	return count - 1; // that of the folder
}

enum status capacity_init(struct capacity *capacity, struct error *err)
{
	struct rlimit limit;
	const unsigned own = DAEMONS_OWN + count_open();
	const rlim_t wanted = own + capacity_descriptors(&all);
	if (room_limit_mib() > 0 && room_limit_mib() < ROOM_LEAST_MIB) {
		error_set(err, STATUS_MEMORY, "loader and worker have no room to start");
		room_advise(err->text, sizeof err->text);
		return STATUS_MEMORY;
	}
	if (getrlimit(RLIMIT_NOFILE, &limit) != 0)
		return error_errno(err, STATUS_INTERNAL, "cannot tell how many descriptors there may be");
	if (limit.rlim_cur < wanted) {
		limit.rlim_cur = limit.rlim_max < wanted ? limit.rlim_max : wanted;
		if (setrlimit(RLIMIT_NOFILE, &limit) != 0)
			return error_errno(err, STATUS_INTERNAL, "cannot raise the limit of descriptors");
	}
	const unsigned has = limit.rlim_cur < wanted ? (unsigned)limit.rlim_cur : (unsigned)wanted;
	if (has <= own || !capacity_divide(capacity, has - own))
		return error_set(
		    err, STATUS_LIMIT,
		    "%u descriptors are too few to serve anybody: raise the hard limit (ulimit -n, LimitNOFILE=) to "
		    "%u, for fewer clients to less",
		    has, (unsigned)wanted);
	if (capacity->connections < all.connections || capacity->scenes < all.scenes)
		log_line(LOG_WARNING,
			 "%u descriptors are enough for %u connections and %u scenes: raise the hard limit (ulimit -n, "
			 "LimitNOFILE=) to %u for %u and %u",
			 has, capacity->connections, capacity->scenes, (unsigned)wanted, all.connections, all.scenes);
	return STATUS_OK;
}
