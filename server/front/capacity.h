// How many connections, scenes and waiting images the process's descriptors are enough for.
//
// Every connection has places for its socket, for a folder's descriptor that comes with a LOAD, and for one encoded image
// that waits for it; every scene has one for its folder or its blob. What else the daemon ever has open at a time is a fixed
// number. So whatever clients do, no descriptor that the daemon counts on is missing: what does not fit is refused or waits.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_CAPACITY_H
#define CANDIL_FRONT_CAPACITY_H

#include <stdbool.h>

#include "server/base/error.h"

struct capacity {
	unsigned connections; // LIMIT_CONNECTIONS at most
	unsigned scenes; // with a name or being loaded: LIMIT_SCENES at most. As many again may be kept by jobs alone
	unsigned images; // that wait beside the first one of each connection: 2 * LIMIT_JOBS at most
};

// The descriptors that all of `capacity` takes, beside those of the daemon itself.
unsigned capacity_descriptors(const struct capacity *capacity);

// Divide `descriptors` between the three. False: they are too few to serve anybody.
bool capacity_divide(struct capacity *capacity, unsigned descriptors);

// Raise the process's soft limit of descriptors as far as is of use and allowed, and divide what it allows. It tells the
// log if that is less than the daemon's own limits, and how to mend it. Failure: STATUS_LIMIT, too few to serve anybody;
// STATUS_MEMORY, a limit of address space in which no child could be linked.
enum status capacity_init(struct capacity *capacity, struct error *err);

#endif
