#include "server/worker/code_store.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>
#include <xxhash.h>

#include "server/base/temporary.h"

#define PREFIX "candil_module_"
#define SPIRV_MAGIC 0x07230203u
#define SPIRV_WORDS_LEAST 5u // of its header

struct head {
	char magic[8];
	uint64_t number, bytes;
	uint64_t hash[2]; // of number and code
};

static struct head head_of(uint64_t number, const uint32_t *code, size_t bytes)
{
	struct head h = {.magic = "candilm1", .number = number, .bytes = bytes};
	const XXH128_hash_t hash = XXH3_128bits_withSeed(code, bytes, number);
	h.hash[0] = hash.low64;
	h.hash[1] = hash.high64;
	return h;
}

static void name_of(uint64_t number, char name[48])
{
	snprintf(name, 48, PREFIX "%016llx", (unsigned long long)number);
}

// Read the file's code, whatever it is.
static uint32_t *read_code(int fd, struct head *head)
{
	struct stat about;
	if (fstat(fd, &about) != 0 || !S_ISREG(about.st_mode) || read(fd, head, sizeof *head) != (ssize_t)sizeof *head)
		return NULL;
	if (head->bytes > CODE_STORE_BYTES_MAX || head->bytes < SPIRV_WORDS_LEAST * sizeof(uint32_t) ||
	    head->bytes % sizeof(uint32_t) != 0 || (uint64_t)about.st_size != sizeof *head + head->bytes)
		return NULL;
	uint32_t *code = malloc(head->bytes);
	if (code && read(fd, code, head->bytes) == (ssize_t)head->bytes)
		return code;
	free(code);
	return NULL;
}

uint32_t *code_store_read(int folder, uint64_t number, size_t *bytes)
{
	char name[48];
	struct head head, right;
	name_of(number, name);
	const int fd = folder < 0 ? -1 : openat(folder, name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (fd < 0)
		return NULL;
	uint32_t *code = read_code(fd, &head);
	if (code) {
		right = head_of(number, code, head.bytes);
		if (memcmp(&right, &head, sizeof head) != 0 || code[0] != SPIRV_MAGIC) {
			free(code);
			code = NULL;
		}
	}
	if (code) {
		*bytes = head.bytes;
		futimens(fd, NULL); // it is in use
	}
	close(fd);
	return code;
}

static bool before(struct timespec a, struct timespec b)
{
	return a.tv_sec != b.tv_sec ? a.tv_sec < b.tv_sec : a.tv_nsec < b.tv_nsec;
}

// Make room for one more.
static void trim(int folder)
{
	char oldest[48] = "";
	struct timespec least = {0};
	unsigned count = 0;
	const int own = openat(folder, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	DIR *list = own < 0 ? NULL : fdopendir(own);
	if (!list) {
		if (own >= 0)
			close(own);
		return;
	}
	for (const struct dirent *entry; (entry = readdir(list));) {
		struct stat about;
		if (strncmp(entry->d_name, PREFIX, strlen(PREFIX)) != 0 || strlen(entry->d_name) >= sizeof oldest ||
		    fstatat(folder, entry->d_name, &about, AT_SYMLINK_NOFOLLOW) != 0)
			continue;
		count++;
		if (oldest[0] && !before(about.st_mtim, least))
			continue;
		least = about.st_mtim;
		memcpy(oldest, entry->d_name, strlen(entry->d_name) + 1);
	}
	closedir(list);
	if (count >= CODE_STORE_MOST)
		unlinkat(folder, oldest, 0);
}

void code_store_write(int folder, uint64_t number, const uint32_t *code, size_t bytes)
{
	char name[48];
	struct temporary t;
	if (folder < 0 || bytes > CODE_STORE_BYTES_MAX)
		return;
	struct head head = head_of(number, code, bytes);
	const struct iovec parts[] = {{&head, sizeof head}, {(void *)(uintptr_t)code, bytes}};
	name_of(number, name);
	trim(folder);
	if (temporary_open(&t, folder, ".", 0600) && writev(t.fd, parts, 2) == (ssize_t)(sizeof head + bytes))
		temporary_place(&t, -1, name);
	temporary_finish(&t);
}
