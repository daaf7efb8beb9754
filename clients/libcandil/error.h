// How every call of the library says that it failed.
#ifndef CANDIL_LIBCANDIL_ERROR_H
#define CANDIL_LIBCANDIL_ERROR_H

#include "clients/libcandil/candil.h"

// Fill `error`, which may be NULL, with a code and a sentence. Returns `code`.
candil_status error_set(struct candil_error *error, candil_status code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Refuse a call that lacks a pointer: `given` says whether all are there that `which` names.
candil_status error_if_missing(bool given, const char *which, struct candil_error *error);

#endif
