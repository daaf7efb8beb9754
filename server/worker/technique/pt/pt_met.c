#include "server/worker/technique/pt/pt_met.h"

#include <stdlib.h>

#include "server/worker/technique/common/resolve.h"
#include "shaders/shared/scene_params.h"

enum status pt_met_read(const struct technique_job *j, uint32_t **met, struct error *err)
{
	const uint64_t bytes = met_bytes(j->plan.width, j->plan.height);
	*met = malloc(bytes);
	if (!*met)
		return error_set(err, STATUS_MEMORY, "out of memory");
	return buffer_read(&j->counters, j->device, sizeof(struct pass_counters), bytes, *met, err);
}
