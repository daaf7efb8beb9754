#include "server/base/drivers.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/folders.h"

static const char *const devices[] = {
    "/dev/null",     "/dev/zero",     "/dev/full",         "/dev/random", "/dev/urandom",
    "/dev/dri", // Mesa's, AMD's and Intel's
    "/dev/kfd", // AMD's
    "/dev/dxg", // Windows's
    "/dev/nvmap", // NVIDIA's Jetson's, with nvhost* and nvgpu/
    "/dev/nvgpu",    "/dev/nvsciipc", "/dev/host1x-fence",
    "/dev/kgsl-3d0", // Qualcomm's
    "/dev/galcore", // Vivante's
    "/dev/ion", // Android's memory for the two above
    "/dev/pvr_sync", // Imagination's
    "/dev/udmabuf",  "/dev/dma_heap",
};

static const char *const devices_by_pattern[] = {"/dev/nvidia*", "/dev/nvhost*", "/dev/mali*", "/dev/accel*"};

bool drivers_cache(char path[PATH_MAX])
{
	const char *mesa = getenv("MESA_SHADER_CACHE_DIR"), *xdg = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
	int length = 0;
	if (mesa && *mesa == '/')
		length = snprintf(path, PATH_MAX, "%s", mesa);
	else if (xdg && *xdg == '/')
		length = snprintf(path, PATH_MAX, "%s/candil", xdg);
	else if (home && *home == '/')
		length = snprintf(path, PATH_MAX, "%s/.cache/candil", home);
	if (length <= 0 || length >= PATH_MAX)
		path[0] = 0;
	return path[0] && make_folders(path) && access(path, W_OK | X_OK) == 0;
}

void drivers_allow(struct landlock *l, const char *cache)
{
	const char *settings = getenv("VK_LAYER_SETTINGS_PATH");
	for (size_t i = 0; i < sizeof devices / sizeof devices[0]; i++)
		landlock_allow(l, devices[i], USE_DEVICE);
	for (size_t i = 0; i < sizeof devices_by_pattern / sizeof devices_by_pattern[0]; i++) {
		glob_t found;
		if (glob(devices_by_pattern[i], GLOB_NOSORT, NULL, &found) == 0) {
			for (size_t k = 0; k < found.gl_pathc; k++)
				landlock_allow(l, found.gl_pathv[k], USE_DEVICE);
			globfree(&found);
		}
	}
	if (*cache)
		landlock_allow(l, cache, USE_KEEP);
	const char *validation = getenv("CANDIL_VALIDATION");
	if (settings && validation && !strcmp(validation, "1"))
		landlock_allow(l, settings, USE_KEEP);
}
