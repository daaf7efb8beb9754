#include "server/worker/manifests.h"

#include <glob.h>
#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/worker/libraries.h"

// Variables that name manifests or folders of them, with colons between.
static const char *const variables[] = {
    "VK_DRIVER_FILES",           "VK_ADD_DRIVER_FILES",    "VK_ICD_FILENAMES",           "VK_LAYER_PATH",
    "VK_ADD_LAYER_PATH",         "VK_IMPLICIT_LAYER_PATH", "VK_ADD_IMPLICIT_LAYER_PATH", "__EGL_VENDOR_LIBRARY_FILENAMES",
    "__EGL_VENDOR_LIBRARY_DIRS",
};

// The folders beneath which Vulkan's loader has its own, vulkan/: a variable and what holds where it is not set, beneath the
// home folder or as a list.
static const struct {
	const char *variable, *at_home, *otherwise;
} bases[] = {
    {"XDG_CONFIG_HOME", ".config", NULL},    {"XDG_CONFIG_DIRS", NULL, "/etc/xdg"},
    {"XDG_DATA_HOME", ".local/share", NULL}, {"XDG_DATA_DIRS", NULL, "/usr/local/share:/usr/share"},
    {NULL, NULL, "/etc:/usr/local/etc"},
};

// Where EGL's loader looks.
static const char vendors[] = "/etc/glvnd/egl_vendor.d:/usr/share/glvnd/egl_vendor.d";

static const char *const folders[] = {"icd.d", "implicit_layer.d", "explicit_layer.d"};

// A path in a manifest may begin at the manifest's folder; a bare name is the linker's to find.
static void allow_library(struct landlock *l, const char *manifest, const char *library)
{
	char path[PATH_MAX];
	const char *slash = strrchr(manifest, '/');
	if (!library || !strchr(library, '/'))
		return;
	const int length = library[0] == '/' ? snprintf(path, sizeof path, "%s", library)
					     : snprintf(path, sizeof path, "%.*s/%s", slash ? (int)(slash - manifest) : 1,
							slash ? manifest : ".", library);
	if (length > 0 && (size_t)length < sizeof path)
		libraries_allow(l, path);
}

static void allow_library_of(struct landlock *l, const char *manifest, const json_t *object)
{
	allow_library(l, manifest, json_string_value(json_object_get(object, "library_path")));
}

static void allow_manifest(struct landlock *l, const char *path)
{
	json_t *root = json_load_file(path, 0, NULL);
	const json_t *layers = json_object_get(root, "layers");
	landlock_allow(l, path, USE_READ);
	allow_library_of(l, path, json_object_get(root, "ICD"));
	allow_library_of(l, path, json_object_get(root, "layer"));
	for (size_t i = 0; i < json_array_size(layers); i++)
		allow_library_of(l, path, json_array_get(layers, i));
	json_decref(root);
}

// A manifest, or a folder with some.
static void allow_manifests(struct landlock *l, const char *path)
{
	char pattern[PATH_MAX];
	glob_t found;
	const int length = snprintf(pattern, sizeof pattern, "%s/*.json", path);
	landlock_allow(l, path, USE_READ);
	if (length < 0 || (size_t)length >= sizeof pattern)
		return;
	if (glob(pattern, GLOB_NOSORT, NULL, &found) != 0) {
		allow_manifest(l, path);
		return;
	}
	for (size_t i = 0; i < found.gl_pathc; i++)
		allow_manifest(l, found.gl_pathv[i]);
	globfree(&found);
}

static void allow_base(struct landlock *l, const char *base)
{
	char path[PATH_MAX];
	int length = snprintf(path, sizeof path, "%s/vulkan", base);
	if (base[0] != '/' || length < 0 || (size_t)length >= sizeof path)
		return;
	landlock_allow(l, path, USE_READ); // with the settings of layers and of the loader
	for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
		length = snprintf(path, sizeof path, "%s/vulkan/%s", base, folders[i]);
		if (length > 0 && (size_t)length < sizeof path)
			allow_manifests(l, path);
	}
}

static void allow_each(struct landlock *l, const char *list, void (*allow)(struct landlock *l, const char *path))
{
	char *copy = list ? strdup(list) : NULL, *rest = copy;
	for (char *path; rest && (path = strsep(&rest, ":"));)
		if (*path)
			allow(l, path);
	free(copy);
}

void manifests_allow(struct landlock *l)
{
	const char *home = getenv("HOME");
	char path[PATH_MAX];
	for (size_t i = 0; i < sizeof variables / sizeof variables[0]; i++)
		allow_each(l, getenv(variables[i]), allow_manifests);
	allow_each(l, vendors, allow_manifests);
	for (size_t i = 0; i < sizeof bases / sizeof bases[0]; i++) {
		const char *list = bases[i].variable ? getenv(bases[i].variable) : NULL;
		if (list && *list) {
			allow_each(l, list, allow_base);
		} else if (bases[i].at_home && home) {
			const int length = snprintf(path, sizeof path, "%s/%s", home, bases[i].at_home);
			if (length > 0 && (size_t)length < sizeof path)
				allow_base(l, path);
		} else {
			allow_each(l, bases[i].otherwise, allow_base);
		}
	}
}
