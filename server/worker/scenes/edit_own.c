#include <stdlib.h>
#include <string.h>

#include "server/worker/scenes/edit.h"

void *edit_own(struct edited *e, enum blob_section section, uint32_t more)
{
	const size_t stride = blob_stride(section), count = e->view.counts[section];
	void *copy = malloc((count + more + 1) * stride); // no overflow: counts are within the limits of a blob
	if (!copy)
		return NULL;
	memcpy(copy, e->view.sections[section], count * stride);
	free(e->own[section]);
	e->own[section] = copy;
	e->view.sections[section] = copy;
	return copy;
}
