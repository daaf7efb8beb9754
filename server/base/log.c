#include "server/base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const level_names[] = {"error", "warning", "info", "debug"};
static const char *log_program = "candil";
static enum log_level log_least = LOG_INFO;

void log_init(const char *program, enum log_level level)
{
	log_program = program;
	log_least = level;
	const char *wanted = getenv("CANDIL_LOG");
	if (!wanted)
		return;
	for (unsigned i = 0; i < sizeof level_names / sizeof *level_names; i++)
		if (!strcmp(wanted, level_names[i]))
			log_least = (enum log_level)i;
}

void log_line(enum log_level level, const char *format, ...)
{
	if (level > log_least)
		return;
	char line[1024];
	int used = snprintf(line, sizeof line, "%s[%d] %s: ", log_program, (int)getpid(), level_names[level]);
	va_list args;
	va_start(args, format);
	int text = vsnprintf(line + used, sizeof line - (size_t)used - 1, format, args);
	va_end(args);
	if (text < 0)
		return;
	size_t length = strlen(line);
	line[length++] = '\n';
	// If the log cannot be written, there is nowhere to report it.
	ssize_t ignored = write(STDERR_FILENO, line, length);
	(void)ignored;
}
