// Options of a request by name: what they may be, and what they are when nobody says.
#ifndef CANDIL_WORKER_PLAN_OPTIONS_H
#define CANDIL_WORKER_PLAN_OPTIONS_H

#include "server/worker/plan.h"

void plan_options_default(struct plan *plan);

// Take one option over into the plan, whose technique is settled. STATUS_BAD_ARGUMENT for a name or a value that does not
// exist, with those that do, and for an option that does nothing in this technique, with the one whose it is.
enum status plan_option(const candil_Option *option, struct plan *plan, struct error *err);

// Whether what all options say together can be. STATUS_BAD_ARGUMENT if not.
enum status plan_options_check(const struct plan *plan, struct error *err);

#endif
