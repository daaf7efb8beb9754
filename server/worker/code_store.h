// Shader modules that were specialised (vk/specialise.h), kept on disk for the processes to come, where the driver keeps its
// cache: to make one takes as long as half of what the driver does with it when it has the machine code already.
//
// Design note. The folder holds machine code of the driver, which all who can write there could replace as well; so a module
// is held to a hash against what a disk, a kill or another build leaves, and not against them. A file is written whole or
// not at all, and one that is anything else than a module by its length, number and hash is as none: the module is made
// anew, and takes its place.
//
// Device's thread only. Nothing fails: what cannot be read or written is not kept.
#ifndef CANDIL_WORKER_CODE_STORE_H
#define CANDIL_WORKER_CODE_STORE_H

#include <stddef.h>
#include <stdint.h>

// Of a module that is kept, and how many are: beyond that the one that was not used for longest goes.
#define CODE_STORE_BYTES_MAX (4u << 20)
#define CODE_STORE_MOST 96u

// The module of a number in the open folder, *bytes of it, for the caller to free(); NULL: none is kept. A negative folder
// is allowed, which has none.
uint32_t *code_store_read(int folder, uint64_t number, size_t *bytes);

// Keep it.
void code_store_write(int folder, uint64_t number, const uint32_t *code, size_t bytes);

#endif
