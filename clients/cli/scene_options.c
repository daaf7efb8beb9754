#include "clients/cli/scene_options.h"

#include <string.h>
#include <strings.h>

bool scene_option(int option, const char *text, struct candil_load_request *request)
{
	if (option == OPTION_UNIT)
		return cli_parse_double(text, &request->metres_per_unit) && request->metres_per_unit > 0;
	if (strcmp(text, "y") == 0)
		request->up = CANDIL_UP_Y;
	else if (strcmp(text, "z") == 0)
		request->up = CANDIL_UP_Z;
	else
		return false;
	return true;
}

const char *scene_option_form(int option)
{
	return option == OPTION_UNIT ? "a length in metres above 0" : "y or z";
}

enum exit_code scene_option_refuse(const struct command *self, int option, const char *text)
{
	return cli_usage(self, "--%s takes %s, not \"%s\"", option == OPTION_UNIT ? "unit" : "up", scene_option_form(option),
			 text);
}

bool scene_options_given(const struct candil_load_request *request)
{
	return request->up != CANDIL_UP_DEFAULT || request->metres_per_unit != 0;
}

bool scene_options_fit(const char *file, const struct candil_load_request *request)
{
	const char *dot = strrchr(file, '.');
	bool gltf = dot && (strcasecmp(dot, ".gltf") == 0 || strcasecmp(dot, ".glb") == 0);
	return !gltf || !scene_options_given(request);
}
