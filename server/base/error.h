// A failure on its way up: a stable code and one sentence that says what to do. Functions that can fail return the code
// and fill the sentence; a caller that adds nothing passes both on. No errno travels: error_errno() puts it in words.
#ifndef CANDIL_BASE_ERROR_H
#define CANDIL_BASE_ERROR_H

#include "protocol/limits.h"
#include "protocol/status.h"

struct error {
	enum status code;
	char text[LIMIT_TEXT + 1];
};

// Set code and sentence, cut to fit. Returns `code`, so `return error_set(err, STATUS_X, "…")` is the usual call.
// `err` may be NULL: the code alone is kept.
enum status error_set(struct error *err, enum status code, const char *format, ...) __attribute__((format(printf, 3, 4)));

// The same with ": <errno in words>" behind the sentence. Reads errno first of all.
enum status error_errno(struct error *err, enum status code, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
