// Design note. The loader parses hostile files: whatever it sends may have been written by the author of the file. So its
// sizes are believed only after the blob's seals are checked, from when on nobody can change them; its text is cleaned; and
// its status codes are passed on only if they are about scenes.
#include "server/front/loader.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <unistd.h>

#include "protocol/text.h"
#include "server/base/clock.h"
#include "server/base/memfd.h"

void loader_init(struct loader *loader, struct children *children, const struct options *options, loader_done *done,
		 void *owner)
{
	*loader =
	    (struct loader){.loop = children->loop, .children = children, .options = options, .done = done, .owner = owner};
	child_init(&loader->child);
}

void loader_stop(struct loader *loader)
{
	watch_end(&loader->watch);
	child_abandon(&loader->child, loader->children);
}

static void loader_fail(struct loader *loader, const struct error *err)
{
	struct ipc_loaded *loaded = calloc(1, sizeof *loaded);
	if (!loaded)
		abort(); // without memory for twenty kilobytes nothing else would work either
	loaded->error = *err;
	loader_stop(loader);
	loader->done(loader->owner, loaded, -1);
	free(loaded);
}

static void clean_info(candil_SceneInfo *info)
{
	text_clean(info->file, sizeof info->file);
	text_clean(info->hash, sizeof info->hash);
	text_clean(info->light_units, sizeof info->light_units);
	for (size_t i = 0; i < info->cameras_count; i++)
		text_clean(info->cameras[i].name, sizeof info->cameras[i].name);
	for (size_t i = 0; i < info->warnings_count; i++)
		text_clean(info->warnings[i], sizeof info->warnings[i]);
	for (size_t i = 0; i < info->ignored_count; i++)
		text_clean(info->ignored[i], sizeof info->ignored[i]);
	for (size_t i = 0; i < info->facts_count; i++)
		text_clean(info->facts[i], sizeof info->facts[i]);
	for (size_t i = 0; i < info->nodes_count; i++)
		text_clean(info->nodes[i], sizeof info->nodes[i]);
	for (size_t i = 0; i < info->material_names_count; i++)
		text_clean(info->material_names[i], sizeof info->material_names[i]);
	for (size_t i = 0; i < info->animations_count; i++)
		text_clean(info->animations[i].name, sizeof info->animations[i].name);
}

static bool counts_hold(const candil_SceneInfo *info)
{
	return info->cameras_count <= sizeof info->cameras / sizeof *info->cameras &&
	       info->warnings_count <= sizeof info->warnings / sizeof *info->warnings &&
	       info->ignored_count <= sizeof info->ignored / sizeof *info->ignored &&
	       info->facts_count <= sizeof info->facts / sizeof *info->facts &&
	       info->nodes_count <= sizeof info->nodes / sizeof *info->nodes &&
	       info->material_names_count <= sizeof info->material_names / sizeof *info->material_names &&
	       info->animations_count <= sizeof info->animations / sizeof *info->animations;
}

static void clean_error(struct error *err)
{
	text_clean(err->text, sizeof err->text);
	bool scene = err->code >= STATUS_SCENE_NOT_FOUND && err->code < STATUS_CANCELLED;
	if (err->code != STATUS_OK && err->code != STATUS_MEMORY && !scene)
		err->code = STATUS_SCENE_INVALID;
}

// Check a message and its blob. loaded->error gets what is wrong with them.
static void judge_message(struct ipc_loaded *loaded, size_t bytes, int blob)
{
	const void *map;
	size_t size;
	struct error *err = &loaded->error;
	if (bytes != sizeof *loaded || loaded->head.op != IPC_LOADED ||
	    strncmp(loaded->build, ipc_build(), sizeof loaded->build) != 0) {
		error_set(err, STATUS_LOADER_LOST, "candil-loader is of another build than candild: install both anew");
		return;
	}
	clean_error(err);
	if (err->code != STATUS_OK)
		return;
	if (blob == IPC_LOST_FD) {
		error_set(err, STATUS_MEMORY, "no descriptor was left for the scene: load it again when less is under way");
	} else if (blob < 0 || !counts_hold(&loaded->info)) {
		error_set(err, STATUS_LOADER_LOST, "the loader sent no scene that could be used");
	} else if (memfd_map_sealed(blob, &map, &size, err) == STATUS_OK) {
		munmap((void *)(uintptr_t)map, size);
		loaded->info.blob_bytes = size;
		if (size > LIMIT_BLOB_BYTES)
			error_set(err, STATUS_SCENE_LIMIT, "the scene takes more than %llu bytes", LIMIT_BLOB_BYTES);
		clean_info(&loaded->info);
	} else {
		err->code = STATUS_LOADER_LOST;
	}
}

// Take the loader's message, if there is one, and tell the owner. True if there was one: the run is over.
static bool loader_take(struct loader *loader)
{
	union {
		struct ipc_loaded loaded;
		uint8_t space[IPC_MAX_BYTES];
	} *message = calloc(1, sizeof *message);
	size_t bytes = 0;
	int blob = -1;
	bool came = message && loader->child.socket >= 0 &&
		    ipc_receive(loader->child.socket, message, sizeof *message, &bytes, &blob, NULL) == STATUS_OK &&
		    bytes > 0;
	if (came) {
		judge_message(&message->loaded, bytes, blob);
		if (message->loaded.error.code != STATUS_OK) {
			if (blob >= 0)
				close(blob);
			blob = -1;
		}
		loader_stop(loader);
		loader->done(loader->owner, &message->loaded, blob);
	}
	free(message);
	return came;
}

// Take one word that its message has to wait, if there is one.
static bool loader_waits(struct loader *loader)
{
	struct ipc_head head;
	size_t bytes;
	int fd = -1;
	if (loader->child.socket < 0 || !ipc_next_is(loader->child.socket, IPC_WAITS))
		return false;
	ipc_receive(loader->child.socket, &head, sizeof head, &bytes, &fd, NULL);
	if (fd >= 0)
		close(fd);
	watch_forgive(&loader->watch);
	return true;
}

static void loader_spoke(void *owner, uint32_t events)
{
	struct loader *loader = owner;
	if (loader_waits(loader) || loader_take(loader))
		return;
	// The loader hung up, or what it said was no message. Nothing more is read of it; loader_ended will find out how it
	// ended.
	(void)events;
	loop_forget(loader->loop, loader->child.socket);
	child_kill(&loader->child);
}

static void loader_ended(void *owner, uint32_t events)
{
	struct loader *loader = owner;
	char how[64];
	struct error err;
	(void)events;
	while (loader_waits(loader))
		continue;
	if (loader_take(loader))
		return;
	if (child_reap(&loader->child, loader->children, how, sizeof how) == SIGXCPU)
		error_set(
		    &err, STATUS_SCENE_LIMIT,
		    "the scene takes more than %u s of processor time to read: make it smaller, the file may be broken",
		    LIMIT_LOAD_SECONDS);
	else
		error_set(&err, STATUS_LOADER_LOST,
			  "the loader was lost while it read the file (%s): the file may be broken", how);
	loader_fail(loader, &err);
}

static unsigned patience_s(const struct loader *loader)
{
	return loader->options->hang_s > 0 ? loader->options->hang_s : LIMIT_HANG_SECONDS;
}

// The limit of processor time is the kernel's. The one of the clock is for what works too little to come by it: whoever
// wrote the file may have the loader by now, and another load waits for its end.
static bool loader_looked(void *owner, bool hangs, uint64_t work_us)
{
	struct loader *loader = owner;
	struct error err;
	(void)work_us;
	if (!hangs && clock_us() < loader->end_us)
		return true;
	if (hangs)
		error_set(&err, STATUS_SCENE_LIMIT,
			  "the loader hung: for %u s it neither worked on the file nor waited for a processor or a disk",
			  patience_s(loader));
	else
		error_set(&err, STATUS_SCENE_LIMIT,
			  "the scene takes more than %u s to read: load it when less is under way, or make it smaller",
			  LIMIT_LOAD_CLOCK_SECONDS);
	loader_fail(loader, &err);
	return false;
}

enum status loader_start(struct loader *loader, const struct source *source, candil_UpAxis up, double metres_per_unit,
			 bool images, struct error *err)
{
	char program[4096], unit[32];
	snprintf(unit, sizeof unit, "%.17g", metres_per_unit);
	int length = snprintf(program, sizeof program, "%s/candil-loader", loader->options->libexec);
	if (length < 0 || (size_t)length >= sizeof program)
		return error_set(err, STATUS_INTERNAL, "the path of candil-loader is too long");
	char file_option[] = "--file", up_option[] = "--up", unit_option[] = "--unit", y[] = "y", z[] = "z",
	     images_option[] = "--images";
	char file[LIMIT_PATH + 1];
	memcpy(file, source->file, sizeof file);
	char *const argv[] = {program,
			      file_option,
			      file,
			      up_option,
			      up == candil_UpAxis_UP_Z ? z : y,
			      unit_option,
			      unit,
			      images ? images_option : NULL,
			      NULL};
	enum status status = child_start(&loader->child, PROGRAM_LOADER, argv, source->folder, err);
	if (status != STATUS_OK)
		return status;
	status = loop_watch(loader->loop, loader->child.socket, EPOLLIN, loader_spoke, loader, err);
	if (status == STATUS_OK)
		status = loop_watch(loader->loop, loader->child.pidfd, EPOLLIN, loader_ended, loader, err);
	if (status != STATUS_OK) {
		loader_stop(loader);
		return status;
	}
	loader->end_us = clock_us() + LIMIT_LOAD_CLOCK_SECONDS * 1000000ull;
	watch_begin(&loader->watch, loader->loop, loader->child.pid, patience_s(loader), loader_looked, loader);
	return STATUS_OK;
}
