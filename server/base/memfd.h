// Anonymous memory that is passed between processes by descriptor: scene blobs and encoded frames. The writer creates,
// fills, unmaps and seals it. From then on nobody can change or shrink it, so a reader may check it once and then trust it.
// Readers map it with MAP_PRIVATE, because a sealed memfd refuses MAP_SHARED with PROT_WRITE. Any thread.
#ifndef CANDIL_BASE_MEMFD_H
#define CANDIL_BASE_MEMFD_H

#include <stddef.h>

#include "server/base/error.h"

// Create a close-on-exec memfd of `bytes` and map it for writing at *map. The caller owns both; memfd_seal ends the
// mapping. STATUS_MEMORY, STATUS_INTERNAL.
enum status memfd_create_mapped(const char *name, size_t bytes, int *fd, void **map, struct error *err);

// Create an empty one, which grows by what is appended. The caller owns it; memfd_seal, with a map of NULL, ends it. Of what
// could not be appended a part may have been. STATUS_MEMORY.
enum status memfd_create_empty(const char *name, int *fd, struct error *err);
enum status memfd_append(int fd, const void *data, size_t bytes, struct error *err);

// Unmap and seal (shrink, grow, write, seal). Afterwards the content is immutable. STATUS_INTERNAL.
enum status memfd_seal(int fd, void *map, size_t bytes, struct error *err);

// Map a sealed memfd for reading; *bytes becomes its size. Fails unless it is a memfd with SHRINK and WRITE sealed: only
// such a file can neither fault nor change under the reader. Unmap with munmap.
enum status memfd_map_sealed(int fd, const void **map, size_t *bytes, struct error *err);

#endif
