// What graphics drivers write: devices, and a folder of compiled shaders. The front, whose fence its children inherit, and
// the worker allow the same. One thread.
//
// Design note. A driver's cache holds machine code that later processes run. Other programs of the user keep theirs in
// folders that all share; the worker, which might be taken over, is given one of its own beneath them.
#ifndef CANDIL_BASE_DRIVERS_H
#define CANDIL_BASE_DRIVERS_H

#include <limits.h>
#include <stdbool.h>

#include "server/base/landlock.h"

// Find the folder of compiled shaders, by the environment, and make it: $MESA_SHADER_CACHE_DIR, or candil beneath
// $XDG_CACHE_HOME or $HOME/.cache. "": it has no place. False: it cannot be written to.
bool drivers_cache(char path[PATH_MAX]);

// Allow using the devices that are there, and keeping files in `cache` ("": nowhere) and in the folder in which validation
// layers have their settings ($VK_LAYER_SETTINGS_PATH), for they may leave a log there.
void drivers_allow(struct landlock *l, const char *cache);

#endif
