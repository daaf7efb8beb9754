// Anonymous memory that travels between processes by descriptor: scene blobs and encoded frames.
// The writer creates, fills, unmaps and seals; from then on nobody can change or shrink it, so a reader may check it once
// and trust it after. Readers map MAP_PRIVATE (a sealed memfd refuses MAP_SHARED with PROT_WRITE).
#ifndef CANDIL_BASE_MEMFD_H
#define CANDIL_BASE_MEMFD_H

#include <stddef.h>

#include "server/base/error.h"

// A new memfd of `bytes`, close-on-exec, mapped for writing at *map. Caller owns both; end with memfd_seal.
enum status memfd_create_mapped(const char *name, size_t bytes, int *fd, void **map, struct error *err);

// Unmap and seal (shrink, grow, write, seal). After it the content is immutable.
enum status memfd_seal(int fd, void *map, size_t bytes, struct error *err);

// Map a sealed memfd for reading. Fails unless it is a memfd with SHRINK and WRITE sealed: only those cannot fault or change
// under the reader. *bytes is its size. Unmap with munmap.
enum status memfd_map_sealed(int fd, const void **map, size_t *bytes, struct error *err);

#endif
