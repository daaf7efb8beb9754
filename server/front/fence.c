#include "server/front/fence.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "server/base/deny.h"
#include "server/base/drivers.h"
#include "server/base/folders.h"

static void allow_folder_of(struct landlock *l, const char *file, enum landlock_use use)
{
	char folder[PATH_MAX];
	snprintf(folder, sizeof folder, "%s", file);
	char *slash = strrchr(folder, '/');
	if (slash)
		slash[slash == folder] = 0;
	landlock_allow(l, slash ? folder : ".", use);
}

static void allow_changes(struct landlock *l, const struct options *options)
{
	char cache[PATH_MAX];
	const bool writable = drivers_cache(cache);
	drivers_allow(l, writable ? cache : "");
	if (options->state[0] && make_folders(options->state))
		landlock_allow(l, options->state, USE_KEEP);
	if (options->socket[0])
		allow_folder_of(l, options->socket, USE_SOCKET);
	// A loader offers itself to whoever ends processes for want of memory, in /proc/self. To root's processes /proc also
	// has the kernel's own settings: there it does without.
	if (geteuid() != 0)
		landlock_allow(l, "/proc", USE_DEVICE);
}

void front_fence_enter(const struct options *options, struct fence_report *report)
{
	struct landlock l;
	*report = (struct fence_report){.threads = fence_threads()};
	fence_privileges(&report->layers[FENCE_PRIVILEGES]);
	landlock_begin(&l, SCOPE_CHANGES);
	allow_changes(&l, options);
	const int abi = l.abi;
	fence_state_landlock(&report->layers[FENCE_LANDLOCK], landlock_enter(&l), abi, report->threads);
}

void front_fence_stop_sockets(struct fence_report *report)
{
	fence_state_deny(&report->layers[FENCE_SECCOMP], deny_common());
}
