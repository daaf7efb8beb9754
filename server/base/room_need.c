#include "server/base/room_need.h"

#include <sched.h>

#include "server/base/room.h"

enum status room_need(uint64_t bytes, const char *what, struct error *err)
{
	if (room_left(bytes))
		return STATUS_OK;
	error_set(err, STATUS_MEMORY, "%llu MiB of address space are not left for %s", (unsigned long long)(bytes >> 20),
		  what);
	if (err)
		room_advise(err->text, sizeof err->text);
	return STATUS_MEMORY;
}

enum status room_need_device(struct error *err)
{
	cpu_set_t set;
	const unsigned most = ROOM_DEVICE_THREADS;
	const unsigned threads = sched_getaffinity(0, sizeof set, &set) == 0 ? (unsigned)CPU_COUNT(&set) : most;
	return room_need(ROOM_DEVICE_BYTES + ROOM_DEVICE_THREAD_BYTES * (threads < most ? threads : most),
			 "a device and its driver", err);
}
