// The checks of a request's edits: everything that can be known without the scene.
#ifndef CANDIL_FRONT_REQUEST_EDITS_H
#define CANDIL_FRONT_REQUEST_EDITS_H

#include "candil.pb.h"
#include "server/base/error.h"

// Are the numbers finite and within their limits, the names clean, the directions and quaternions longer than zero?
// Failures: STATUS_BAD_ARGUMENT, STATUS_LIMIT.
enum status request_check_edits(const candil_Edits *edits, struct error *err);

enum status request_check_time(double time_s, struct error *err);

#endif
