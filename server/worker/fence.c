#include "server/worker/fence.h"

#include <jansson.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/deny.h"
#include "server/base/drivers.h"
#include "server/base/landlock.h"
#include "server/worker/cache.h"

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
    "/etc/vulkan",
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

// Beneath the home folder: a user's own drivers, layers and settings.
static const char *const readable_at_home[] = {".drirc", ".config/vulkan", ".local/share/vulkan", ".nv"};

// Variables that hold paths to read, separated by colons, and the key under which a file of theirs names a library.
static const struct {
	const char *name;
	const char *object;
} path_variables[] = {
    {"LD_LIBRARY_PATH", NULL},           {"LD_PRELOAD", NULL},
    {"LIBGL_DRIVERS_PATH", NULL},        {"GBM_BACKENDS_PATH", NULL},
    {"VK_DRIVER_FILES", "ICD"},          {"VK_ADD_DRIVER_FILES", "ICD"},
    {"VK_ICD_FILENAMES", "ICD"},         {"VK_LAYER_PATH", NULL},
    {"VK_ADD_LAYER_PATH", NULL},         {"__EGL_VENDOR_LIBRARY_FILENAMES", "ICD"},
    {"__EGL_VENDOR_LIBRARY_DIRS", NULL},
};

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

// A driver's manifest names its library, by a path that may begin at the manifest's folder.
static void allow_library_of(struct landlock *l, const char *manifest, const char *object)
{
	json_t *root = json_load_file(manifest, 0, NULL);
	const char *library = json_string_value(json_object_get(json_object_get(root, object), "library_path"));
	const char *slash = strrchr(manifest, '/');
	char path[PATH_MAX];
	if (library && strchr(library, '/')) {
		const int length = snprintf(path, sizeof path, "%.*s/%s", slash ? (int)(slash - manifest) : 1,
					    slash ? manifest : ".", library);
		if (library[0] == '/')
			allow_folder_of(l, library);
		else if (length > 0 && (size_t)length < sizeof path)
			allow_folder_of(l, path);
	}
	json_decref(root);
}

static void allow_variable(struct landlock *l, const char *name, const char *object)
{
	const char *value = getenv(name);
	char *copy = value ? strdup(value) : NULL, *rest = copy;
	for (char *path; rest && (path = strsep(&rest, ":"));) {
		if (!*path)
			continue;
		landlock_allow(l, path, USE_READ);
		if (object)
			allow_library_of(l, path, object);
	}
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
		allow_variable(l, path_variables[i].name, path_variables[i].object);
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
