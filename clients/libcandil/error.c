#include "clients/libcandil/error.h"

#include <stdarg.h>
#include <stdio.h>

candil_status error_set(struct candil_error *error, candil_status code, const char *format, ...)
{
	if (error) {
		va_list args;
		va_start(args, format);
		error->code = code;
		vsnprintf(error->text, sizeof(error->text), format, args);
		va_end(args);
	}
	return code;
}

candil_status error_if_missing(bool given, const char *which, struct candil_error *error)
{
	return given ? CANDIL_STATUS_OK : error_set(error, CANDIL_STATUS_BAD_ARGUMENT, "NULL was given for %s", which);
}
