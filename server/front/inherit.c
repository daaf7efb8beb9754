#include "server/front/inherit.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

// Whole names wherever there are few: a prefix may be a service's too, whose key has it.
static const struct variable {
	const char *name; // one that ends with '_' stands for all that begin so
	bool loader, worker;
} variables[] = {
    // ours
    {"CANDIL_LOG", true, true}, // server/base/log.c
    {"CANDIL_VALIDATION", false, true}, // Vulkan's and OpenGL's checks
    // which libraries are linked, and where they are looked for
    {"LD_LIBRARY_PATH", true, true},
    {"LD_PRELOAD", true, true},
    // a build with sanitizers
    {"ASAN_OPTIONS", true, true},
    {"LSAN_OPTIONS", true, true},
    {"UBSAN_OPTIONS", true, true},
    // threads of OpenImageIO and of OpenMP, which it links
    {"OPENIMAGEIO_THREADS", true, true},
    {"OMP_NUM_THREADS", true, true},
    // where compiled shaders are kept, and where drivers and layers of a user are found
    {"HOME", false, true},
    {"XDG_CACHE_HOME", false, true},
    {"XDG_CONFIG_HOME", false, true},
    {"XDG_CONFIG_DIRS", false, true},
    {"XDG_DATA_HOME", false, true},
    {"XDG_DATA_DIRS", false, true},
    // Vulkan's loader and layers
    {"VK_DRIVER_FILES", false, true},
    {"VK_ADD_DRIVER_FILES", false, true},
    {"VK_ICD_FILENAMES", false, true},
    {"VK_INSTANCE_LAYERS", false, true},
    {"VK_ADD_LAYER_PATH", false, true},
    {"VK_IMPLICIT_LAYER_PATH", false, true},
    {"VK_ADD_IMPLICIT_LAYER_PATH", false, true},
    {"VK_LAYER_", false, true},
    {"VK_LOADER_", false, true},
    {"VK_KHRONOS_VALIDATION_", false, true},
    // EGL and OpenGL
    {"EGL_PLATFORM", false, true},
    {"EGL_LOG_LEVEL", false, true},
    {"__EGL_VENDOR_LIBRARY_DIRS", false, true},
    {"__EGL_VENDOR_LIBRARY_FILENAMES", false, true},
    {"LIBGL_", false, true},
    {"GBM_BACKENDS_PATH", false, true},
    // Mesa: all drivers, its software drivers, the choice of a GPU, and by driver
    {"MESA_", false, true},
    {"GALLIUM_", false, true},
    {"LP_", false, true},
    {"DRI_PRIME", false, true},
    {"NIR_DEBUG", false, true},
    {"RADV_DEBUG", false, true},
    {"RADV_PERFTEST", false, true},
    {"ACO_DEBUG", false, true},
    {"AMD_DEBUG", false, true},
    {"AMD_VULKAN_ICD", false, true},
    {"ANV_DEBUG", false, true},
    {"INTEL_DEBUG", false, true},
    {"NVK_DEBUG", false, true},
    {"TU_DEBUG", false, true},
    {"V3D_DEBUG", false, true},
    // NVIDIA's driver, and which of its GPUs a container or scheduler has given out
    {"__GL_", false, true},
    {"__NV_PRIME_RENDER_OFFLOAD", false, true},
    {"__VK_LAYER_NV_optimus", false, true},
    {"CUDA_VISIBLE_DEVICES", false, true},
};

static bool is(const struct variable *v, const char *entry)
{
	const size_t length = strlen(v->name);
	return strncmp(entry, v->name, length) == 0 && (v->name[length - 1] == '_' || entry[length] == '=');
}

static bool inherits(enum program program, const char *entry)
{
	for (size_t i = 0; i < sizeof variables / sizeof variables[0]; i++)
		if (is(&variables[i], entry))
			return program == PROGRAM_LOADER ? variables[i].loader : variables[i].worker;
	return false;
}

char **inherit_environment(enum program program, char *const environment[])
{
	size_t count = 0, kept = 0;
	while (environment[count])
		count++;
	char **some = calloc(count + 1, sizeof *some);
	for (size_t i = 0; some && i < count; i++)
		if (inherits(program, environment[i]))
			some[kept++] = environment[i];
	return some;
}
