// A hostile study folder, as candil-report reads it: study.json is what comes before the first byte 0, runs.jsonl the rest.
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/report/figures.h"
#include "server/report/judge.h"
#include "server/report/results.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static char folder[64];

static void file_name(char path[128], const char *name)
{
	snprintf(path, 128, "%s/%s", folder, name);
}

static void remove_folder(void)
{
	char path[128];
	file_name(path, "study.json");
	unlink(path);
	file_name(path, "runs.jsonl");
	unlink(path);
	rmdir(folder);
}

static void write_file(const char *name, const uint8_t *data, size_t size)
{
	char path[128];
	file_name(path, name);
	FILE *file = fopen(path, "wbe");
	if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
		abort();
}

static void report(struct study *study)
{
	struct figures figures = {0};
	struct judgement judgement = {0};
	struct error err;
	if (figures_measure(study, &figures, &err) == STATUS_OK && judge(&figures, &judgement, &err) == STATUS_OK) {
		json_decref(results_json(&figures, &judgement));
		free(results_csv(&figures));
		json_decref(ablation_json(&figures));
	}
	judge_finish(&judgement);
	figures_finish(&figures);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	const uint8_t *end = memchr(data, 0, size);
	const size_t head = end ? (size_t)(end - data) : size;
	struct study study = {0};
	struct error err;
	const char *tmp = getenv("TMPDIR");
	if (!folder[0]) {
		snprintf(folder, sizeof folder, "%.30s/candil-fuzz-XXXXXX", tmp ? tmp : "/tmp");
		if (!mkdtemp(folder))
			abort();
		atexit(remove_folder);
	}
	write_file("study.json", data, head);
	write_file("runs.jsonl", end ? end + 1 : data, end ? size - head - 1 : 0);
	if (study_read(folder, &study, &err) == STATUS_OK)
		report(&study);
	study_finish(&study);
	return 0;
}
