// bench_path LOADER SCENE SAMPLES [OPTION=VALUE | all]...: what one sample per pixel costs the path tracer, 512 × 512.
//
// Prints the processors' time and the wall clock's, milliseconds a sample per pixel, and rays a second: one line for each of
// five turns. To compare two builds, run them in turns.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "server/base/clock.h"
#include "server/worker/devices.h"
#include "server/worker/image/frame.h"
#include "server/worker/plan/make.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/pt/pt.h"
#include "tests/support/load_scene.h"

#define TURNS 5
#define SLICE_US 50000u

static void must(enum status s, const struct error *err)
{
	if (s == STATUS_OK)
		return;
	printf("FAIL: %s\n", err->text);
	exit(1);
}

static double processor_ms(void)
{
	struct rusage u;
	getrusage(RUSAGE_SELF, &u);
	return 1e3 * (double)(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
	       1e-3 * (double)(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

static void turn(struct device *device, struct resident_scene *scene, const struct plan *plan)
{
	struct technique_job *job;
	struct error err;
	struct frame *frame;
	must(technique_pt.begin(&(struct devices){.vk = device}, scene, plan, &job, &err), &err);
	const uint64_t start = clock_us();
	const double busy = processor_ms();
	struct step_result result = STEP_RESULT_NOTHING;
	while (!result.finished)
		must(technique_pt.step(job, SLICE_US, &result, &err), &err);
	const double wall = 1e-3 * (double)(clock_us() - start);
	const double used = processor_ms() - busy;
	must(technique_pt.read(job, &frame, &err), &err);
	double mean = 0;
	for (uint64_t i = 0; i < 3ull * frame->width * frame->height; i++)
		mean += (double)frame->radiance[i];
	printf("%8.1f ms processor %8.1f ms wall  %6.2f Mrays/s  %.3f rays/sample  mean %.6f\n", used / plan->samples,
	       wall / plan->samples, (double)frame->rays / wall / 1e3,
	       (double)frame->rays / plan->samples / plan->width / plan->height, mean / (3.0 * plan->width * plan->height));
	fflush(stdout);
	frame_destroy(frame);
	technique_pt.end(job);
}

static void add_option(candil_Render *r, const char *text)
{
	const char *equals = strchr(text, '=');
	candil_Option *o = &r->options[r->options_count++];
	if (!equals || r->options_count > LIMIT_OPTIONS) {
		fprintf(stderr, "an option is NAME=VALUE\n");
		exit(2);
	}
	snprintf(o->name, sizeof o->name, "%.*s", (int)(equals - text), text);
	snprintf(o->value, sizeof o->value, "%s", equals + 1);
}

int main(int argc, char **argv)
{
	struct device *device;
	struct loaded_scene loaded;
	struct plan plan;
	struct error err;
	const struct device_options options = {0};
	static candil_Render request = candil_Render_init_zero;
	if (argc < 4) {
		fprintf(stderr, "usage: bench_path LOADER SCENE SAMPLES [OPTION=VALUE]...\n");
		return 2;
	}
	if (device_create(&options, &device, &err) != STATUS_OK) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	must(load_scene(argv[1], argv[2], &loaded, &err), &err);
	struct resident_scene scene = {.blob = loaded.blob, .bytes = loaded.bytes, .fd = loaded.fd};
	blob_view_init(&scene.view, loaded.blob);
	request.width = request.height = 512;
	request.samples = (uint32_t)strtoul(argv[3], NULL, 10);
	for (int i = 4; i < argc; i++)
		if (!strcmp(argv[i], "all"))
			request.effects_on = ~0u;
		else
			add_option(&request, argv[i]);
	must(plan_make(&request, &scene.view, NULL, NULL, &plan, &err), &err);
	for (int i = 0; i < TURNS; i++)
		turn(device, &scene, &plan);
	for (unsigned i = 0; i < BIND_SCENE_COUNT; i++)
		buffer_finish(&scene.buffers[i], device);
	loaded_scene_finish(&loaded);
	devices_finish(&(struct devices){.vk = device});
	return 0;
}
