#include "server/worker/code_list.h"

#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include "server/base/ipc.h"

#define FILE_NAME "candil_code"

// Mesa's own switch: without its cache what has been compiled is lost with the process.
static bool cache_is_off(void)
{
	static const char *const words[] = {"1", "y", "yes", "t", "true"};
	const char *off = getenv("MESA_SHADER_CACHE_DISABLE");
	for (size_t i = 0; off && i < sizeof words / sizeof *words; i++)
		if (!strcasecmp(off, words[i]))
			return true;
	return false;
}

// Read what others have added. The file only grows, or begins anew.
static void catch_up(struct code_list *list)
{
	struct stat info;
	if (fstat(list->file, &info) != 0)
		return;
	// What a full disk or a kill has left of a number would shift all that is written behind it: the list begins anew.
	if (info.st_size % (off_t)sizeof *list->pieces != 0) {
		list->count = 0;
		if (ftruncate(list->file, 0) != 0)
			return;
		info.st_size = 0;
	}
	if (info.st_size < (off_t)(list->count * sizeof *list->pieces))
		list->count = 0;
	const size_t room = (CODE_LIST_MOST - list->count) * sizeof *list->pieces;
	const ssize_t n = pread(list->file, list->pieces + list->count, room, (off_t)(list->count * sizeof *list->pieces));
	if (n > 0)
		list->count += (uint32_t)((size_t)n / sizeof *list->pieces);
}

static bool has(const struct code_list *list, uint64_t number)
{
	for (uint32_t i = 0; i < list->count; i++)
		if (list->pieces[i] == number)
			return true;
	return false;
}

void code_list_open(struct code_list *list, const char *folder, const char *device)
{
	char path[PATH_MAX];
	*list = CODE_LIST_NONE;
	const int n = snprintf(path, sizeof path, "%s/" FILE_NAME, folder);
	if (!folder[0] || n < 0 || (size_t)n >= sizeof path || cache_is_off())
		return;
	list->pieces = calloc(CODE_LIST_MOST, sizeof *list->pieces);
	if (list->pieces)
		list->file = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0600);
	if (list->file < 0) {
		code_list_close(list);
		return;
	}
	list->folder = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
	const char *build = ipc_build();
	list->device = code_piece(code_piece(0, device, strlen(device)), build, strlen(build));
	catch_up(list);
}

void code_list_close(struct code_list *list)
{
	if (list->file >= 0)
		close(list->file);
	if (list->folder >= 0)
		close(list->folder);
	free(list->pieces);
	*list = CODE_LIST_NONE;
}

uint64_t code_piece(uint64_t before, const void *part, size_t bytes)
{
	return XXH3_64bits_withSeed(part, bytes, before);
}

uint64_t code_list_number(const struct code_list *list, uint64_t piece)
{
	return code_piece(list->device, &piece, sizeof piece) | 1u;
}

enum status code_list_ask(struct code_list *list, uint64_t piece, struct error *err)
{
	const uint64_t number = code_list_number(list, piece);
	if (list->at_will || list->file < 0 || has(list, number))
		return STATUS_OK;
	catch_up(list);
	if (has(list, number))
		return STATUS_OK;
	list->refused = number;
	return error_set(err, STATUS_INTERNAL, "shader code has to be compiled first");
}

void code_list_add(struct code_list *list, uint64_t piece)
{
	const uint64_t number = code_list_number(list, piece);
	list->added++;
	if (list->file < 0 || has(list, number))
		return;
	catch_up(list);
	if (has(list, number))
		return;
	if (list->count == CODE_LIST_MOST && ftruncate(list->file, 0) == 0)
		list->count = 0;
	if (write(list->file, &number, sizeof number) > 0)
		catch_up(list);
}
