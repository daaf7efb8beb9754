#include "server/worker/fence.h"

#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/deny.h"
#include "server/base/drivers.h"
#include "server/base/landlock.h"
#include "server/worker/cache.h"
#include "server/worker/image/codec.h"
#include "server/worker/libraries.h"
#include "server/worker/manifests.h"

// Programs and libraries, drivers' settings, and what the kernel tells. /proc has other processes' secrets: landlock keeps
// them from a process that may not trace the other, so from this one.
static const char *const readable[] = {
    "/usr",
    "/lib",
    "/lib32",
    "/lib64",
    "/opt",
    "/nix/store",
    "/gnu/store",
    "/run/opengl-driver",
    "/etc/ld.so.cache",
    "/etc/glvnd",
    "/etc/egl",
    "/etc/drirc",
    "/etc/nvidia",
    "/proc",
    "/sys/bus",
    "/sys/class",
    "/sys/dev",
    "/sys/devices",
    "/sys/module",
    "/sys/kernel/mm",
    "/sys/fs/cgroup",
};

// Beneath the home folder: a user's own settings.
static const char *const readable_at_home[] = {".drirc", ".nv"};

// Variables that hold paths to read, separated by colons, beside those of manifests.
static const char *const path_variables[] = {"LD_LIBRARY_PATH", "LD_PRELOAD", "LIBGL_DRIVERS_PATH", "GBM_BACKENDS_PATH"};

// ---- files -----------------------------------------------------------------------------------------------------------

static void allow_folder_of(struct landlock *l, const char *path)
{
	const char *slash = strrchr(path, '/');
	char folder[PATH_MAX];
	if (!slash || slash == path || (size_t)(slash - path) >= sizeof folder)
		return;
	snprintf(folder, sizeof folder, "%.*s", (int)(slash - path), path);
	landlock_allow(l, folder, USE_READ);
}

// What is linked already tells where libraries lie here, the program among them.
static int allow_linked(struct dl_phdr_info *info, size_t size, void *landlock)
{
	(void)size;
	allow_folder_of(landlock, info->dlpi_name);
	return 0;
}

static void allow_variable(struct landlock *l, const char *name)
{
	const char *value = getenv(name);
	char *copy = value ? strdup(value) : NULL, *rest = copy;
	for (char *path; rest && (path = strsep(&rest, ":"));)
		if (*path)
			landlock_allow(l, path, USE_READ);
	free(copy);
}

static void allow_files(struct landlock *l, const struct worker_fence *fence)
{
	char self[PATH_MAX], path[PATH_MAX];
	const ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
	const char *home = getenv("HOME");
	if (length > 0) {
		self[length] = 0;
		allow_folder_of(l, self);
		snprintf(path, sizeof path, "%.*s/" CODEC_FILE, (int)(strrchr(self, '/') - self), self);
		libraries_allow(l, path); // linked when the first scene comes
	}
	dl_iterate_phdr(allow_linked, l);
	for (size_t i = 0; i < sizeof readable / sizeof readable[0]; i++)
		landlock_allow(l, readable[i], USE_READ);
	for (size_t i = 0; home && i < sizeof readable_at_home / sizeof readable_at_home[0]; i++) {
		const int written = snprintf(path, sizeof path, "%s/%s", home, readable_at_home[i]);
		if (written > 0 && (size_t)written < sizeof path)
			landlock_allow(l, path, USE_READ);
	}
	for (size_t i = 0; i < sizeof path_variables / sizeof path_variables[0]; i++)
		allow_variable(l, path_variables[i]);
	manifests_allow(l);
	drivers_allow(l, fence->cache_writable ? fence->cache : "");
}

// ---- the whole -------------------------------------------------------------------------------------------------------

void worker_fence_enter(struct worker_fence *fence)
{
	struct landlock l;
	struct fence_state *states = fence->report.layers;
	*fence = (struct worker_fence){.report.threads = fence_threads()};
	const bool writable = drivers_cache(fence->cache);
	fence->cache_writable = writable && cache_has_room(fence->cache);
	fence->cache_full = writable && !fence->cache_writable;
	if (fence->cache_full)
		cache_turn_off();
	if (fence->cache[0]) {
		setenv("XDG_CACHE_HOME", fence->cache, 1);
		setenv("__GL_SHADER_DISK_CACHE_PATH", fence->cache, 1); // NVIDIA's
	}
	fence_privileges(&states[FENCE_PRIVILEGES]);
	landlock_begin(&l, SCOPE_ALL);
	allow_files(&l, fence);
	const int abi = l.abi;
	fence_state_landlock(&states[FENCE_LANDLOCK], landlock_enter(&l), abi, fence->report.threads);
	fence_state_deny(&states[FENCE_SECCOMP], deny_programs());
}
