#include "tests/daemon/fake.h"

#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

#include "server/base/memfd.h"

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
