#include "server/loader/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/openat2.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

static int open_as(int dir, const char *name, int flags)
{
	struct open_how how = {
	    .flags = (uint64_t)(unsigned)(flags | O_CLOEXEC),
	    .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS,
	};
	return (int)syscall(SYS_openat2, dir, name, &how, sizeof how);
}

// O_NONBLOCK: opening a FIFO in the folder must not block the loader before it is recognised as no regular file.
static int open_beneath(int dir, const char *name)
{
	return open_as(dir, name, O_RDONLY | O_NONBLOCK | O_NOCTTY);
}

static enum status open_failed(const char *name, struct error *err)
{
	if (errno == EXDEV || errno == ELOOP)
		return error_set(err, STATUS_SCENE_PATH, "'%.100s' leads out of the scene's folder; put the file beneath it",
				 name);
	return error_errno(err, STATUS_SCENE_FILE, "cannot open '%.100s' in the scene's folder", name);
}

static enum status check_size(const struct files *files, const char *name, const struct stat *st, struct error *err)
{
	if (!S_ISREG(st->st_mode))
		return error_set(err, STATUS_SCENE_FILE, "'%.100s' is not a regular file", name);
	if ((uint64_t)st->st_size > LIMIT_SCENE_FILE_BYTES)
		return error_set(err, STATUS_SCENE_LIMIT, "'%.100s' has %lld bytes; a scene file may have %llu", name,
				 (long long)st->st_size, (unsigned long long)LIMIT_SCENE_FILE_BYTES);
	if ((uint64_t)st->st_size > LIMIT_SCENE_SOURCE_BYTES - files->bytes_read)
		return error_set(err, STATUS_SCENE_LIMIT, "with '%.100s' the scene's files exceed %llu bytes together", name,
				 (unsigned long long)LIMIT_SCENE_SOURCE_BYTES);
	return STATUS_OK;
}

static enum status read_all(int fd, const char *name, size_t size, struct file_bytes *out, struct error *err)
{
	uint8_t *data = malloc(size + 1);
	if (!data)
		return error_set(err, STATUS_MEMORY, "no memory for the %zu bytes of '%.100s'", size, name);
	size_t done = 0;
	while (done < size) {
		ssize_t n = read(fd, data + done, size - done);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0) {
			free(data);
			return error_set(err, STATUS_SCENE_FILE, "cannot read '%.100s' to its end", name);
		}
		done += (size_t)n;
	}
	data[size] = 0;
	out->data = data;
	out->size = size;
	return STATUS_OK;
}

enum status files_open_folder(int dir, const char *path, int *folder, const char **name, struct error *err)
{
	const char *slash = strrchr(path, '/');
	char *above = slash ? strndup(path, (size_t)(slash - path)) : strdup(".");
	*name = slash ? slash + 1 : path;
	if (!above)
		return error_set(err, STATUS_MEMORY, "no memory for a path");
	*folder = open_as(dir, above, O_PATH | O_DIRECTORY);
	enum status status = *folder >= 0 ? STATUS_OK : open_failed(above, err);
	free(above);
	return status;
}

enum status files_read(struct files *files, const char *name, struct file_bytes *out, struct error *err)
{
	struct stat st;
	*out = (struct file_bytes){0};
	int fd = open_beneath(files->dir, name);
	if (fd < 0)
		return open_failed(name, err);
	enum status status = fstat(fd, &st) == 0 ? check_size(files, name, &st, err)
						 : error_errno(err, STATUS_SCENE_FILE, "cannot look at '%.100s'", name);
	if (status == STATUS_OK)
		status = read_all(fd, name, (size_t)st.st_size, out, err);
	if (status == STATUS_OK)
		files->bytes_read += out->size;
	close(fd);
	return status;
}

bool files_exists(const struct files *files, const char *name)
{
	struct stat st;
	int fd = open_beneath(files->dir, name);
	if (fd < 0)
		return false;
	bool regular = fstat(fd, &st) == 0 && S_ISREG(st.st_mode);
	close(fd);
	return regular;
}

// Put the entry of a folder that has this name, else the one that has it in any case, behind `found`, whose first `used`
// bytes name the folder.
static bool find_entry(struct files *files, const char *name, size_t length, char *found, size_t used)
{
	found[used] = '\0';
	const bool may_look = files->entries_read <= LIMIT_FOLDER_ENTRIES;
	const int fd = may_look ? open_as(files->dir, used ? found : ".", O_RDONLY | O_DIRECTORY) : -1;
	DIR *folder = fd >= 0 ? fdopendir(fd) : NULL;
	unsigned matches = 0;
	bool exact = false;
	if (!folder) {
		if (fd >= 0)
			close(fd);
		return false;
	}
	bool cut = false;
	for (struct dirent *e; !exact && !cut && (e = readdir(folder)); cut = ++files->entries_read > LIMIT_FOLDER_ENTRIES)
		if (strlen(e->d_name) == length && strncasecmp(e->d_name, name, length) == 0) {
			memcpy(found + used, e->d_name, length + 1);
			exact = strncmp(e->d_name, name, length) == 0;
			matches++;
		}
	closedir(folder);
	return exact || (matches == 1 && !cut);
}

bool files_find_in_any_case(struct files *files, const char *name, char *found)
{
	size_t used = 0;
	while (*name) {
		const size_t length = strcspn(name, "/");
		if (!find_entry(files, name, length, found, used))
			return false;
		used += length;
		name += length;
		while (*name == '/')
			name++;
		if (*name)
			found[used++] = '/';
	}
	return used > 0 && files_exists(files, found);
}

void file_bytes_finish(struct file_bytes *bytes)
{
	free(bytes->data);
	*bytes = (struct file_bytes){0};
}
