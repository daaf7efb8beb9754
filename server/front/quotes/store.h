// The file in which the model outlives the daemon: STATE/quotes. Its bytes are QUOTE_FILE_MAGIC, a version, the sizes of
// what follows, a checksum, then habits and records as they are in memory, little-endian. It is written anew and renamed
// into place, so that it is whole if the daemon dies; it is not forced to the disk, and what a loss of power leaves of it is
// told by its checksum. Of two daemons that share it the one that writes last keeps its own records and as many of those
// that it finds there as fit: two that have LIMIT_QUOTE_RECORDS each drop the other's. What is damaged, of another version
// or of another machine's layout is left aside with a line in the log.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_QUOTES_STORE_H
#define CANDIL_FRONT_QUOTES_STORE_H

#include <limits.h>
#include <stddef.h>

#include "server/base/error.h"
#include "server/front/loop.h"
#include "server/front/quotes/model.h"

#define QUOTE_STORE_PAUSE_US 5000000u // from the first new record to the file

struct quote_store {
	char folder[PATH_MAX]; // "": no file
	struct loop *loop;
	struct quote_model *model;
	struct loop_timer timer;
	bool dirty; // the model has what the file has not
	bool failed; // it could not be written: said once
};

// Read the file of `folder` into the empty `model`. A folder that is missing is made when something is written. Nothing
// fails: without a file that can be read the model stays empty.
void quote_store_open(struct quote_store *store, const char *folder, struct loop *loop, struct quote_model *model);

// The model has something new: write it some seconds from now.
void quote_store_mark(struct quote_store *store);

// Write what is new, and stop.
void quote_store_close(struct quote_store *store);

// The bytes of a model, from malloc; NULL: no memory.
uint8_t *quote_store_encode(const struct quote_model *model, size_t *bytes);

// Read bytes that anyone may have written into an empty model. STATUS_BAD_MESSAGE, with the reason, and the model stays
// empty.
enum status quote_store_decode(const uint8_t *data, size_t bytes, struct quote_model *model, struct error *err);

#endif
