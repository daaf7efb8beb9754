// The pieces of shader code that the driver has compiled on this machine before. Their machine code is in the driver's own
// cache on disk, so each is made in moments; any other takes seconds, and minutes on a busy machine. A worker that serves
// others makes no such piece: it refuses, and a process of its own compiles the piece meanwhile (main.c, --compile).
//
// A piece has a number, 64 bits of a hash over its source, its constants, the device and this build. The list is a file of
// these numbers in the folder where the driver keeps its cache; all workers of a user share it. It is a hint, and nothing
// comes of a wrong one but a wait. Where the driver has no cache there is no list either, and nothing is refused.
//
// Device's thread only.
#ifndef CANDIL_WORKER_CODE_LIST_H
#define CANDIL_WORKER_CODE_LIST_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "server/base/error.h"

// Numbers that a list holds; one more, and it begins anew.
#define CODE_LIST_MOST 4096u

// An open list. Others may set `at_will` and `refused`, and read all else.
struct code_list {
	int file; // -1: none
	int folder; // that it is in; -1: none
	uint32_t count;
	uint64_t *pieces; // owned; CODE_LIST_MOST of them
	uint64_t device; // a hash of device and build
	bool at_will; // refuse nothing
	uint64_t refused; // the piece that was refused last; 0: none since it was last set to 0
	uint32_t added; // calls of code_list_add
};

// Open the list in `folder`, where the driver keeps its cache ("": nowhere), for the device of this name and driver. On any
// failure there is none. CODE_LIST_NONE may stand for one.
void code_list_open(struct code_list *list, const char *folder, const char *device);

#define CODE_LIST_NONE ((struct code_list){.file = -1, .folder = -1})

// Close it. May be called twice.
void code_list_close(struct code_list *list);

// The number of a piece that `part` belongs to, given that of the parts before it; 0 for the first.
uint64_t code_piece(uint64_t before, const void *part, size_t bytes);

// The piece's number in the list, for this device and build. It is never 0.
uint64_t code_list_number(const struct code_list *list, uint64_t piece);

// Ask before a piece is compiled. STATUS_OK: go on. STATUS_INTERNAL: it would take long, and list->refused has its number.
enum status code_list_ask(struct code_list *list, uint64_t piece, struct error *err);

// The piece has been compiled.
void code_list_add(struct code_list *list, uint64_t piece);

#endif
