#include "clients/cli/scene_options.h"

#include <string.h>

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
