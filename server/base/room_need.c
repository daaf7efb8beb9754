#include "server/base/room_need.h"

#include <unistd.h>

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
	const long processors = sysconf(_SC_NPROCESSORS_ONLN);
	const uint64_t most = ROOM_DEVICE_THREADS, threads = processors > 0 ? (uint64_t)processors : 1;
	return room_need(ROOM_DEVICE_BYTES + ROOM_DEVICE_THREAD_BYTES * (threads < most ? threads : most),
			 "a device and its driver", err);
}
