#include "server/base/memfd.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum status memfd_create_mapped(const char *name, size_t bytes, int *fd, void **map, struct error *err)
{
	int f = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING);
	if (f < 0)
		return error_errno(err, STATUS_MEMORY, "cannot create shared memory for %s", name);
	errno = EINVAL; // for sizes that no file has
	if (bytes == 0 || bytes > INT64_MAX || ftruncate(f, (off_t)bytes) != 0) {
		if (errno == EFBIG) // shared memory counts as a file
			error_set(
			    err, STATUS_MEMORY,
			    "%zu bytes of shared memory for %s are more than a file may have: raise that limit (ulimit "
			    "-f, LimitFSIZE=)",
			    bytes, name);
		else
			error_errno(err, STATUS_MEMORY, "cannot make %zu bytes of shared memory for %s", bytes, name);
		close(f);
		return STATUS_MEMORY;
	}
	void *m = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, f, 0);
	if (m == MAP_FAILED) {
		error_errno(err, STATUS_MEMORY, "cannot map %zu bytes for %s", bytes, name);
		close(f);
		return STATUS_MEMORY;
	}
	*fd = f;
	*map = m;
	return STATUS_OK;
}

enum status memfd_create_empty(const char *name, int *fd, struct error *err)
{
	*fd = memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING);
	return *fd >= 0 ? STATUS_OK : error_errno(err, STATUS_MEMORY, "cannot create shared memory for %s", name);
}

enum status memfd_append(int fd, const void *data, size_t bytes, struct error *err)
{
	while (bytes > 0) {
		const ssize_t done = write(fd, data, bytes);
		if (done < 0 && errno == EINTR)
			continue;
		if (done <= 0)
			return error_errno(err, STATUS_MEMORY, "cannot write %zu bytes more to shared memory", bytes);
		data = (const char *)data + done;
		bytes -= (size_t)done;
	}
	return STATUS_OK;
}

enum status memfd_seal(int fd, void *map, size_t bytes, struct error *err)
{
	// The kernel refuses F_SEAL_WRITE while a writable shared mapping exists.
	if (map)
		munmap(map, bytes);
	if (fcntl(fd, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_WRITE | F_SEAL_SEAL) != 0)
		return error_errno(err, STATUS_INTERNAL, "cannot seal shared memory");
	return STATUS_OK;
}

enum status memfd_map_sealed(int fd, const void **map, size_t *bytes, struct error *err)
{
	const int needed = F_SEAL_SHRINK | F_SEAL_WRITE;
	int seals = fcntl(fd, F_GET_SEALS);
	if (seals < 0 || (seals & needed) != needed)
		return error_set(err, STATUS_INTERNAL, "shared memory that is not sealed was refused");
	struct stat st;
	if (fstat(fd, &st) != 0 || st.st_size <= 0)
		return error_set(err, STATUS_INTERNAL, "empty shared memory was refused");
	void *m = mmap(NULL, (size_t)st.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
	if (m == MAP_FAILED)
		return error_errno(err, STATUS_MEMORY, "cannot map %lld bytes of shared memory", (long long)st.st_size);
	*map = m;
	*bytes = (size_t)st.st_size;
	return STATUS_OK;
}
