// make_source SYMBOL FILE HEADER DEPFILE INCLUDE_DIR…: writes one GLSL file, its includes expanded, to HEADER as a C
// string, and the list of the files that it read to DEPFILE as a make rule. It runs while candil is built: the worker never
// opens a shader file. Lines of #version and #extension for include directives are dropped. Include guards prevent double
// definitions when a file is included twice.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEPTH_MAX 16
#define LINE_BYTES 1024
#define PATH_BYTES 1024

static FILE *header, *depfile;
static char **roots; // include folders, ended by NULL; the first that has a file provides it

// Writes a line of the source as a string literal: compilers read it far faster than a list of numbers.
static void put(const char *text)
{
	putc('"', header);
	for (; *text && *text != '\n'; text++) {
		if (strchr("\"\\?", *text)) // ? is escaped because of trigraphs
			putc('\\', header);
		putc(*text, header);
	}
	fputs(*text ? "\\n\"\n" : "\"\n", header);
}

// Writes a path to the make rule, escaped for make.
static void put_path(const char *path)
{
	for (; *path; path++) {
		if (strchr(" #", *path))
			putc('\\', depfile);
		else if (*path == '$')
			putc('$', depfile);
		putc(*path, depfile);
	}
}

// Whether a line is `#include "path"`. If so, `path` receives the path.
static int is_include(const char *line, char path[PATH_BYTES])
{
	const char *from = strchr(line, '"');
	if (strncmp(line, "#include", 8) != 0 || !from)
		return 0;
	const char *to = strchr(from + 1, '"');
	if (!to || (size_t)(to - from) > PATH_BYTES)
		return 0;
	memcpy(path, from + 1, (size_t)(to - from - 1));
	path[to - from - 1] = '\0';
	return 1;
}

static int is_dropped(const char *line)
{
	return !strncmp(line, "#version", 8) || !strncmp(line, "#extension GL_GOOGLE_include_directive", 38);
}

// Finds the file of an include. If no folder has it, `whole` is its path in the last folder, so that the error message
// names one.
static void find_include(const char *path, char whole[2 * PATH_BYTES])
{
	for (char **root = roots; *root; root++) {
		snprintf(whole, 2 * PATH_BYTES, "%s/%s", *root, path);
		FILE *f = fopen(whole, "r");
		if (f) {
			fclose(f);
			return;
		}
	}
}

static int expand(const char *file, int depth)
{
	char line[LINE_BYTES], path[PATH_BYTES];
	FILE *f = fopen(file, "r");
	if (!f || depth > DEPTH_MAX) {
		fprintf(stderr, "make_source: cannot read %s\n", file);
		if (f)
			fclose(f);
		return 0;
	}
	fputs(" \\\n ", depfile);
	put_path(file);
	int ok = 1;
	while (ok && fgets(line, sizeof line, f)) {
		if (is_include(line, path)) {
			char whole[2 * PATH_BYTES];
			find_include(path, whole);
			ok = expand(whole, depth + 1);
		} else if (!is_dropped(line)) {
			put(line);
		}
	}
	fclose(f);
	return ok;
}

// Closes a file. False unless all of it was written.
static int close_file(FILE *f)
{
	int ok = f && !ferror(f);
	return (!f || fclose(f) == 0) && ok;
}

int main(int argc, char **argv)
{
	if (argc < 6)
		return 2;
	roots = argv + 5;
	header = fopen(argv[3], "w");
	depfile = fopen(argv[4], "w");
	int ok = header && depfile;
	if (ok) {
		put_path(argv[3]);
		putc(':', depfile);
		const char *slash = strrchr(argv[2], '/');
		fprintf(header, "// Made by make_source out of %s.\nstatic const char %s[] =\n", slash ? slash + 1 : argv[2],
			argv[1]);
		ok = expand(argv[2], 0);
		fputs(";\n", header);
		putc('\n', depfile);
	}
	ok = close_file(header) && ok;
	ok = close_file(depfile) && ok;
	if (!ok)
		fprintf(stderr, "make_source: cannot write %s\n", argv[3]);
	return ok ? 0 : 1;
}
