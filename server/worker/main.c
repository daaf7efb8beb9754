// candil-worker: one process for each device. candild starts it, and it serves candild at descriptor IPC_FD until that
// closes.
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/base/ipc.h"
#include "server/base/library.h"
#include "server/base/log.h"
#include "server/worker/cache.h"
#include "server/worker/devices.h"
#include "server/worker/doctor.h"
#include "server/worker/fence.h"
#include "server/worker/image/codec.h"
#include "server/worker/serve.h"
#include "server/worker/vk/device.h"

static const char usage[] =
    "usage: candil-worker [--device N|UUID|cpu] [--require-gpu] [--memory-budget MIB] [--avoid KEY]…\n"
    "       candil-worker --compile MIB …           compile the code of one job, and exit: MIB of the budget are taken\n"
    "       candil-worker --doctor [--device …]     list the devices as JSON\n"
    "       candil-worker --libraries               only link what pictures need\n"
    "candild starts this program; it serves the descriptor that candild leaves it.\n";

struct settings {
	struct device_options device;
	bool doctor, libraries, compile;
	uint64_t taken; // bytes of the budget that others have
};

static bool parse(int argc, char **argv, struct settings *out)
{
	static const struct option longs[] = {
	    {"device", required_argument, NULL, 'd'},        {"require-gpu", no_argument, NULL, 'g'},
	    {"memory-budget", required_argument, NULL, 'm'}, {"doctor", no_argument, NULL, 'D'},
	    {"avoid", required_argument, NULL, 'a'},         {"libraries", no_argument, NULL, 'L'},
	    {"compile", required_argument, NULL, 'c'},       {NULL, 0, NULL, 0}};
	int c;
	while ((c = getopt_long(argc, argv, "", longs, NULL)) != -1) {
		char *end;
		switch (c) {
		case 'd':
			out->device.wanted = strcmp(optarg, "auto") != 0 ? optarg : NULL;
			break;
		case 'g':
			out->device.require_gpu = true;
			break;
		case 'm':
			out->device.memory_budget = strtoull(optarg, &end, 10) << 20;
			if (*end || end == optarg)
				return false;
			break;
		case 'a':
			if (out->device.avoid_count == DEVICE_MAX)
				return false;
			out->device.avoid[out->device.avoid_count++] = optarg;
			break;
		case 'D':
			out->doctor = true;
			break;
		case 'L':
			out->libraries = true;
			break;
		case 'c':
			out->compile = true;
			out->taken = strtoull(optarg, &end, 10) << 20;
			if (*end || end == optarg)
				return false;
			break;
		default:
			return false;
		}
	}
	return optind == argc;
}

static int link_libraries(void)
{
	struct error err;
	return codec_open(&err) ? 0 : library_missing("candil-worker", &err);
}

// What is left of the budget is for all that may compile at a time.
static void share_budget(struct device *device, uint64_t taken)
{
	device->budget = device->budget > taken ? (device->budget - taken) / LIMIT_COMPILERS : 0;
}

int main(int argc, char **argv)
{
	struct settings settings = {0};
	struct devices devices = {0};
	struct error err = {0};
	static struct worker_fence fence;
	log_init("candil-worker", LOG_WARNING);
	if (!parse(argc, argv, &settings)) {
		fputs(usage, stderr);
		return 2;
	}
	signal(SIGXFSZ, SIG_IGN); // a file that may not become so large has an error of its own
	worker_fence_enter(&fence);
	if (settings.libraries)
		return link_libraries();
	if (settings.doctor)
		return doctor(&settings.device, &fence);
	fence_log(&fence.report);
	if (fence.cache_full)
		log_line(LOG_WARNING, "no room in %s: each start compiles its shaders anew", fence.cache);
	if (!ipc_end_with_parent(IPC_FD))
		return 1;
	signal(SIGPIPE, SIG_IGN);
	signal(SIGINT, SIG_IGN); // Ctrl-C in a terminal is for the front, which then closes the socket
	if (device_create(&settings.device, &devices.vk, &err) != STATUS_OK)
		log_line(LOG_ERROR, "%s", err.text);
	if (devices.vk) {
		code_list_open(&devices.code, fence.cache_writable ? fence.cache : "", devices.vk->info.name);
		devices.vk->code = &devices.code;
		if (fence.cache_writable)
			cache_fill_index(fence.cache);
	}
	if (devices.vk && settings.compile)
		share_budget(devices.vk, settings.taken);
	enum status s = settings.compile ? serve_compiling(IPC_FD, &devices) : serve(IPC_FD, &devices, &err);
	devices_finish(&devices);
	return s == STATUS_OK ? 0 : 1;
}
