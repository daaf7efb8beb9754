// A fence's report for `candil doctor`. One thread.
#ifndef CANDIL_BASE_FENCE_JSON_H
#define CANDIL_BASE_FENCE_JSON_H

#include <jansson.h>

#include "server/base/fence.h"

// {"threads", "layers": [{"name", "holds", "detail"}]}, the caller's; NULL: no memory.
json_t *fence_json(const struct fence_report *report);

#endif
