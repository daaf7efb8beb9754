// A failure that is passed up to the caller: a stable code and one sentence that says what to do. A function that can fail
// returns the code and fills the sentence; a caller that has nothing to add passes both on. errno is not passed up:
// error_errno() puts it into words. Any thread.
#ifndef CANDIL_BASE_ERROR_H
#define CANDIL_BASE_ERROR_H

#include "protocol/limits.h"
#include "protocol/status.h"

struct error {
	enum status code;
	char text[LIMIT_TEXT + 1];
};

// Set code and sentence; the sentence is cut to fit. Returns `code`, so `return error_set(err, STATUS_X, "…")` is the usual
// call. If `err` is NULL, only the code is returned.
enum status error_set(struct error *err, enum status code, const char *format, ...) __attribute__((format(printf, 3, 4)));

// As error_set, with ": " and errno's text appended to the sentence. errno is read before anything can change it.
enum status error_errno(struct error *err, enum status code, const char *format, ...) __attribute__((format(printf, 3, 4)));

#endif
