// The checks of a request's edits: everything that can be known without the scene.
#ifndef CANDIL_FRONT_REQUEST_EDITS_H
#define CANDIL_FRONT_REQUEST_EDITS_H

#include "candil.pb.h"
#include "server/base/error.h"

// Numbers finite and within their limits, names clean, directions and quaternions with a length. BAD_ARGUMENT, LIMIT.
enum status request_check_edits(const candil_Edits *edits, struct error *err);

enum status request_check_time(double time_s, struct error *err);

#endif
