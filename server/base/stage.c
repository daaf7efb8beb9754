#include "server/base/stage.h"

#include <stddef.h>
#include <string.h>

enum stage_kind stage_kind(const char *name)
{
	static const struct {
		const char *name;
		enum stage_kind kind;
	} kinds[] = {
	    {"queue", STAGE_QUEUE},        {"compile", STAGE_COLD},      {"upload", STAGE_SETUP},
	    {"edit", STAGE_SETUP},         {"light-tree", STAGE_SETUP},  {"effects", STAGE_SETUP},
	    {"shadow-maps", STAGE_SETUP},  {"voxelise", STAGE_SETUP},    {"voxel-light", STAGE_SETUP},
	    {"voxel-gather", STAGE_SETUP}, {"pyramid", STAGE_SETUP},     {"aov", STAGE_PIXEL},
	    {"error", STAGE_PIXEL},        {"resolve", STAGE_PIXEL},     {"show", STAGE_PIXEL},
	    {"check", STAGE_SETUP},        {"count", STAGE_PIXEL},       {"encode", STAGE_ENCODE},
	    {"send", STAGE_ENCODE},        {"open", STAGE_COLD},         {"lost", STAGE_QUEUE},
	    {"wait", STAGE_FIXED},         {"encoder", STAGE_FIXED},     {"host", STAGE_PIXEL},
	    {"surfaces", STAGE_SETUP},     {"patch-light", STAGE_SETUP}, {"factors", STAGE_SETUP},
	    {"solve", STAGE_SETUP},        {"corners", STAGE_SETUP},     {"preview", STAGE_PIXEL},
	    {"size", STAGE_QUEUE},         {"residual", STAGE_SETUP},    {"project", STAGE_SETUP},
	    {"import", STAGE_SETUP},
	};
	for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
		if (strcmp(name, kinds[i].name) == 0)
			return kinds[i].kind;
	return STAGE_SAMPLE;
}
