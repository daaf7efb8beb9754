#include "tests/daemon/fake.h"

#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "server/base/memfd.h"

// What a test sets for the stand-ins is in the daemon's environment, of which its children get nothing that is not theirs.
__attribute__((constructor)) static void read_orders(void)
{
	char path[64], entry[4096];
	size_t length = 0;
	snprintf(path, sizeof path, "/proc/%d/environ", (int)getppid());
	FILE *file = fopen(path, "re");
	for (int c; file && (c = getc(file)) != EOF;) {
		if (length < sizeof entry)
			entry[length++] = (char)c;
		if (c)
			continue;
		char *equals = length < sizeof entry ? strchr(entry, '=') : NULL;
		if (equals && strncmp(entry, "FAKE_", 5) == 0) {
			*equals = 0;
			setenv(entry, equals + 1, 1);
		}
		length = 0;
	}
	if (file)
		fclose(file);
}

unsigned long fake_number(const char *name, unsigned long otherwise)
{
	const char *text = getenv(name);
	return text ? strtoul(text, NULL, 10) : otherwise;
}

bool fake_inherited(int last)
{
	DIR *folder = opendir("/proc/self/fd");
	bool found = false;
	if (!folder)
		return true;
	for (struct dirent *entry = readdir(folder); entry; entry = readdir(folder)) {
		int fd = entry->d_name[0] == '.' ? 0 : atoi(entry->d_name);
		found |= fd > last && fd != dirfd(folder);
	}
	closedir(folder);
	return found;
}

int fake_sparse_memfd(unsigned long bytes)
{
	int fd;
	void *map;
	if (memfd_create_mapped("fake", bytes, &fd, &map, NULL) != STATUS_OK ||
	    memfd_seal(fd, map, bytes, NULL) != STATUS_OK)
		exit(9);
	return fd;
}

int fake_memfd(unsigned long bytes, unsigned seed, bool seal)
{
	int fd;
	void *map;
	if (memfd_create_mapped("fake", bytes, &fd, &map, NULL) != STATUS_OK)
		exit(9);
	for (unsigned long i = 0; i < bytes; i++)
		((uint8_t *)map)[i] = (uint8_t)(i * 31 + seed);
	if (!seal)
		munmap(map, bytes);
	else if (memfd_seal(fd, map, bytes, NULL) != STATUS_OK)
		exit(9);
	return fd;
}
