// Design note. A client's descriptor may be of any file system, even of one that never answers. So the front opens nothing
// beneath it and looks at nothing there. The loader does that, and a loader that hangs is killed.
#include "server/front/source.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static int open_beneath(int root, const char *path, int flags)
{
	struct open_how how = {.flags = (uint64_t)(unsigned)(flags | O_PATH | O_CLOEXEC),
			       .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
	return (int)syscall(SYS_openat2, root, path, &how, sizeof how);
}

static enum status explain_failure(const char *path, struct error *err)
{
	if (errno == EXDEV || errno == ELOOP)
		return error_set(err, STATUS_SCENE_PATH, "\"%.150s\" leads out of the scene root", path);
	return error_errno(err, STATUS_SCENE_FILE, "cannot open \"%.150s\" beneath the scene root", path);
}

// Split a path into folder and file; `folder` is "." if the path has none.
static enum status split_path(const char *path, char folder[LIMIT_PATH + 1], char file[LIMIT_PATH + 1], struct error *err)
{
	const char *slash = strrchr(path, '/');
	const char *name = slash ? slash + 1 : path;
	size_t length = slash ? (size_t)(slash - path) : 0;
	if (!*name || strlen(name) > LIMIT_PATH || length > LIMIT_PATH)
		return error_set(err, STATUS_SCENE_PATH, "\"%.150s\" names no file", path);
	memcpy(file, name, strlen(name) + 1);
	if (!slash)
		memcpy(folder, ".", 2);
	else if (length == 0)
		memcpy(folder, "/", 2);
	else
		snprintf(folder, LIMIT_PATH + 1, "%.*s", (int)length, path);
	return STATUS_OK;
}

enum status source_beneath(struct source *source, int root, const char *path, struct error *err)
{
	char folder[LIMIT_PATH + 1];
	source->folder = -1;
	if (root < 0)
		return error_set(err, STATUS_SCENE_PATH,
				 "this daemon was started without --scene-root, beneath which such a path is looked for: "
				 "leave --under-root out, or send a descriptor of the scene's folder");
	enum status status = split_path(path, folder, source->file, err);
	if (status != STATUS_OK)
		return status;
	int file = open_beneath(root, path, 0);
	if (file < 0)
		return explain_failure(path, err);
	struct stat st;
	bool regular = fstat(file, &st) == 0 && S_ISREG(st.st_mode);
	close(file);
	if (!regular)
		return error_set(err, STATUS_SCENE_FILE, "\"%.150s\" is no regular file", path);
	source->folder = open_beneath(root, folder, O_DIRECTORY);
	return source->folder >= 0 ? STATUS_OK : explain_failure(path, err);
}

enum status source_own(struct source *source, const char *path, struct error *err)
{
	char folder[LIMIT_PATH + 1];
	source->folder = -1;
	enum status status = split_path(path, folder, source->file, err);
	if (status != STATUS_OK)
		return status;
	source->folder = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
	if (source->folder < 0)
		return error_errno(err, STATUS_SCENE_FILE, "cannot open the folder of \"%.150s\"", path);
	return STATUS_OK;
}

enum status source_given(struct source *source, int folder, const char *path, struct error *err)
{
	*source = (struct source){.folder = folder};
	int length = snprintf(source->file, sizeof source->file, "%s", path);
	if (length >= 0 && (size_t)length < sizeof source->file)
		return STATUS_OK;
	source_close(source);
	return error_set(err, STATUS_SCENE_PATH, "the path is longer than %u bytes", LIMIT_PATH);
}

void source_close(struct source *source)
{
	if (source->folder >= 0)
		close(source->folder);
	source->folder = -1;
}
