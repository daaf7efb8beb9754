// The arrays of elements.h, and what elements are made of, on the Vulkan device, as shared/radiosity.h numbers them.
// Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENT_BUFFERS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_ELEMENT_BUFFERS_H

#include "server/worker/technique/radiosity/elements.h"
#include "server/worker/vk/buffer.h"

// The buffers of a scene's elements.
struct element_buffers {
	struct buffer faces, triangles, patches; // as the arrays of struct elements
	struct buffer surfaces; // struct radiosity_surface, by element; undefined until somebody writes them
};

// Upload, as far as the elements are made. `surfaces`: make room for them, too. The buffers are the caller's, who finishes
// them. On failure nothing is left. STATUS_MEMORY, STATUS_DEVICE.
enum status element_buffers_init(struct element_buffers *buffers, const struct elements *elements, bool surfaces,
				 struct device *device, struct error *err);

// Upload the patches that were made since `first` were. STATUS_MEMORY, STATUS_DEVICE.
enum status element_buffers_send(struct element_buffers *buffers, const struct elements *elements, uint32_t first,
				 struct device *device, struct error *err);

// Read back the area of each element that is open, m²: that which rays of its row start from, and which others see. Of a
// patch's front it is without the parts that are covered (surfaces.h), of a back all. *areas is the caller's, who frees it;
// NULL after a failure. STATUS_MEMORY, STATUS_DEVICE.
enum status element_buffers_areas(const struct element_buffers *buffers, const struct elements *elements,
				  struct device *device, float **areas, struct error *err);
void element_buffers_finish(struct element_buffers *buffers, struct device *device);

// Put them in their places of binding_set_init's array, which has BIND_MOST.
void element_buffers_fill(const struct element_buffers *buffers, const struct buffer **of);

// Device memory of so many faces, triangles and patches, in bytes.
uint64_t element_buffers_bytes(uint32_t faces, uint32_t triangles, uint32_t patches);

#endif
