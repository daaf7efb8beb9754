// What the matrix of form factors and its solvers cost: rows taken out of a dense buffer, and solutions of random matrices.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/clock.h"
#include "server/worker/devices.h"
#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/vk/device.h"

#define UNIT 0x1p30

static struct error err;
static uint32_t seed = 1;

static uint32_t draw(void)
{
	seed = seed * 747796405u + 2891336453u;
	const uint32_t word = ((seed >> ((seed >> 28) + 4)) ^ seed) * 277803737u;
	return word >> 22 ^ word;
}

static void need(enum status s)
{
	if (s == STATUS_OK)
		return;
	fprintf(stderr, "%s\n", err.text);
	exit(1);
}

// ---- rows from a dense buffer
// ---------------------------------------------------------------------------------------------

static void bench_pack(struct device *device, uint32_t side, uint32_t entries, uint32_t batch, bool on_host)
{
	struct factors f;
	uint32_t *words = calloc((size_t)side * batch, sizeof *words);
	struct factors_put *rows = calloc(batch, sizeof *rows);
	double best = INFINITY;
	if (!words || !rows)
		exit(1);
	for (uint32_t k = 0; k < batch; k++)
		for (uint32_t n = 0; n < entries; n++)
			words[(size_t)k * side + draw() % side] = draw();
	for (uint32_t k = 0; k < batch; k++)
		rows[k].element = k;
	for (int turn = 0; turn < 5; turn++) {
		struct buffer dense;
		need(factors_init(&f, device, side, &err));
		f.packs_on_host = f.packs_on_host && on_host;
		need(buffer_init_with(&dense, device, words, (uint64_t)side * batch * 4, &err));
		const uint64_t start = clock_us();
		need(factors_put_dense(&f, &dense, UNIT, rows, batch, &err));
		best = fmin(best, (double)(clock_us() - start));
		buffer_finish(&dense, device);
		factors_finish(&f);
	}
	printf("| %u | %u | %s | %.1f |\n", side, entries, on_host ? "host" : "shader", best / batch);
	free(words);
	free(rows);
}

int main(void)
{
	const struct device_options options = {0};
	struct device *device;
	need(device_create(&options, &device, &err));
	printf("| columns | entries | by | µs a row |\n| ---: | ---: | --- | ---: |\n");
	for (int on_host = 0; on_host < 2; on_host++)
		for (uint32_t entries = 400; entries <= 1600; entries *= 4)
			bench_pack(device, 25800, entries, 300, on_host);
	devices_finish(&(struct devices){.vk = device});
	return 0;
}
