// bench_voxels LOADER SCENE... : what voxelising a scene costs at each resolution, by pass: processor time of
// all threads in ms, the best of three; other programs beside it matter little to that.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/worker/devices.h"
#include "server/worker/technique/voxel/voxel_build.h"
#include "tests/support/load_scene.h"

#define REPEATS 3

static uint64_t device_bytes, device_budget = 1ull << 33;

static void drop_derived(struct resident_scene *s, struct derived *keep)
{
	while (s->derived != keep) {
		struct derived *d = s->derived;
		s->derived = d->next;
		d->destroy(d);
	}
}

static double processor_ms(void)
{
	struct timespec t;
	clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
	return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

// What a plan would simulate of what colours depend on.
static uint32_t effects_of(uint32_t facts)
{
	static const struct {
		uint32_t fact;
		candil_Effect effect;
	} pairs[] = {{FACT_TEXTURES, candil_Effect_EFFECT_TEXTURES},
		     {FACT_EMITTERS, candil_Effect_EFFECT_EMITTERS},
		     {FACT_GLOSSY, candil_Effect_EFFECT_GLOSSY},
		     {FACT_ALPHA_MASK, candil_Effect_EFFECT_ALPHA_MASK},
		     {FACT_VERTEX_COLORS, candil_Effect_EFFECT_VERTEX_COLORS},
		     {FACT_UNLIT, candil_Effect_EFFECT_UNLIT}};
	uint32_t effects = 0;
	for (unsigned i = 0; i < sizeof pairs / sizeof *pairs; i++)
		effects |= facts & pairs[i].fact ? 1u << pairs[i].effect : 0;
	return effects;
}

// One build; its passes' times are taken where they are less than those so far.
static enum status measure(struct resident_scene *scene, struct gl_device *device, uint32_t resolution,
			   double best[VOXEL_DONE + 1], struct voxels **out, struct error *err)
{
	const struct plan plan = {.effects = effects_of(scene->view.facts), .width = 1, .height = 1};
	const struct voxel_options options = {.resolution = resolution};
	double ms[VOXEL_DONE + 1] = {0};
	double start = processor_ms();
	enum status s = voxels_acquire(scene, device, &plan, &options, out, err);
	ms[VOXEL_DONE] = processor_ms() - start;
	while (s == STATUS_OK && (*out)->build->phase != VOXEL_DONE) {
		const enum voxel_phase phase = (*out)->build->phase;
		start = processor_ms();
		s = voxel_build_piece(*out, 50000, err);
		if (s == STATUS_OK)
			s = gl_wait(device, "voxelising", err);
		ms[phase] += processor_ms() - start;
	}
	for (int i = 0; i <= VOXEL_DONE; i++)
		best[i] = best[i] == 0 || ms[i] < best[i] ? ms[i] : best[i];
	return s;
}

static void bench_scene(struct gl_device *device, const char *loader, const char *file)
{
	struct loaded_scene loaded;
	struct error err = {0};
	if (load_scene(loader, file, &loaded, &err) != STATUS_OK) {
		printf("%s: %s\n", file, err.text);
		return;
	}
	struct resident_scene scene = {.blob = loaded.blob, .bytes = loaded.bytes, .fd = loaded.fd};
	blob_view_init(&scene.view, loaded.blob);
	printf("%s, %u triangles\n%6s %8s %8s %8s %8s %8s %8s %10s %8s\n", file, scene_count(&scene, BLOB_TRIANGLES), "side",
	       "begin", "mark", "count", "sum", "finish", "all", "entries", "MiB");
	for (uint32_t resolution = 64; resolution <= 512; resolution *= 2) {
		double ms[VOXEL_DONE + 1] = {0}, all = 0;
		struct voxels *v = NULL;
		enum status s = STATUS_OK;
		uint32_t entries = 0;
		uint64_t bytes = 0;
		for (int i = 0; s == STATUS_OK && i < REPEATS; i++) {
			s = measure(&scene, device, resolution, ms, &v, &err);
			if (s == STATUS_OK) {
				entries = v->grid.entries;
				bytes = voxels_bytes(v);
			}
			voxels_release(v);
			v = NULL;
		}
		for (int i = 0; i <= VOXEL_DONE; i++)
			all += ms[i];
		if (s == STATUS_OK)
			printf("%6u %8.1f %8.1f %8.1f %8.1f %8.1f %8.1f %10u %8.1f\n", resolution, ms[VOXEL_DONE],
			       ms[VOXEL_MARK], ms[VOXEL_COUNT], ms[VOXEL_SUM], ms[VOXEL_FINISH], all, entries,
			       (double)bytes / 1048576);
		else
			printf("%6u %s\n", resolution, err.text);
		fflush(stdout);
	}
	drop_derived(&scene, NULL);
	loaded_scene_finish(&loaded);
}

int main(int argc, char **argv)
{
	const struct gl_device_options options = {.software = true, .bytes = &device_bytes, .budget = &device_budget};
	struct gl_device *device;
	struct error err;
	if (argc < 3 || gl_device_create(&options, &device, &err) != STATUS_OK)
		return 2;
	for (int i = 2; i < argc; i++)
		bench_scene(device, argv[1], argv[i]);
	devices_finish(&(struct devices){.gl = device});
	return 0;
}
