// Runs a fuzz target over files and folders, for builds without libFuzzer: every input once, and then each truncated and
// each with single bytes flipped, so that a replay looks a little further than the corpus itself. With -runs=0 each once, as
// libFuzzer has it.
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define INPUT_MAX (1u << 20)
#ifndef VARIATIONS
#define VARIATIONS 400u // places of an input that are changed; fewer for targets whose inputs take longer
#endif

static unsigned inputs;
static unsigned variations = VARIATIONS;

// A copy of just the right size, so that a sanitizer sees the first byte past it.
static void run(const uint8_t *data, size_t size)
{
	uint8_t *copy = malloc(size ? size : 1);
	if (!copy)
		abort();
	memcpy(copy, data, size);
	LLVMFuzzerTestOneInput(copy, size);
	free(copy);
	inputs++;
}

static void run_around(uint8_t *data, size_t size)
{
	run(data, size);
	if (variations == 0)
		return;
	size_t stride = size / variations + 1;
	for (size_t i = 0; i < size; i += stride) {
		run(data, i);
		const uint8_t kept = data[i];
		const uint8_t others[] = {0, 0xFF, (uint8_t)(kept ^ 0x80), (uint8_t)(kept + 1)};
		for (size_t k = 0; k < sizeof others; k++) {
			data[i] = others[k];
			run(data, size);
		}
		data[i] = kept;
	}
}

static int run_file(const char *path)
{
	FILE *f = fopen(path, "rb");
	uint8_t *data = malloc(INPUT_MAX);
	const int failed = !f || !data;
	if (failed)
		fprintf(stderr, "cannot read %s\n", path);
	else
		run_around(data, fread(data, 1, INPUT_MAX, f));
	if (f)
		fclose(f);
	free(data);
	return failed;
}

static int run_path(const char *path)
{
	struct stat st;
	if (stat(path, &st) != 0)
		return 1;
	if (!S_ISDIR(st.st_mode))
		return run_file(path);
	DIR *dir = opendir(path);
	struct dirent *entry;
	int bad = 0;
	while (dir && (entry = readdir(dir))) {
		char full[4096];
		if (entry->d_name[0] == '.')
			continue;
		snprintf(full, sizeof full, "%s/%s", path, entry->d_name);
		bad |= run_path(full);
	}
	if (dir)
		closedir(dir);
	return bad;
}

int main(int argc, char **argv)
{
	int bad = 0;
	for (int i = 1; i < argc; i++)
		if (strcmp(argv[i], "-runs=0") == 0)
			variations = 0;
		else
			bad |= run_path(argv[i]);
	printf("%u inputs\n", inputs);
	return bad || inputs == 0;
}
