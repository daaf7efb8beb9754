// Reads a file of form factors, as the worker writes them (patch_file.h), as a scene of its own: the rows of the matrix,
// every number as the file has it, bit for bit. One thread.
#ifndef CANDIL_LOADER_PATCH_MATRIX_H
#define CANDIL_LOADER_PATCH_MATRIX_H

#include "server/loader/import.h"

// Read a Matrix Market file, matrix coordinate real general (Boisvert, Pozo and Remington 1996), square, of entries in any
// order but each place once; `file` is its name for messages. A warning counts rows that sum up to more than 1. Takes time
// linear in the bytes. STATUS_SCENE_UNSUPPORTED: a matrix of another kind. STATUS_SCENE_INVALID: a line or a number is
// wrong. STATUS_SCENE_LIMIT (rows, entries), STATUS_MEMORY.
enum status patch_matrix_import(struct import *import, const char *file, const struct file_bytes *bytes, struct error *err);

#endif
