// Rows of form factors by rays: each element sends rays, evenly spread over its area and by the cosine over directions, and
// F_ij is the share of element i's rays that meet element j. Vulkan; device's thread only.
//
// F = hits / rays has at most the standard error of independent rays, √(F (1 - F) / rays): the rays are a low-discrepancy
// set (ray_table.h), of which each element has its own rotation (Cranley and Patterson 1976). Each row is an unbiased
// estimate. A row's bits depend on the scene, the options and the device alone; not on the batch that it is made in, nor on
// the traversal.
//
// With mirrors, factors are extended (Sillion and Puech 1989): a ray's weight counts for the mirror that it meets, and the
// share that the mirror reflects goes on. So rows may sum up to more than 1. Reflectance is the luminance of
// radiosity_surface.mirror, in the mirror's direction about the geometric normal. What is left of a weight at the limit of
// bounces is told as `cut`.
//
// Example: all rows of a resident scene's elements, on `device`
//	const struct plan plan = {0};
//	const struct rays_options options = {.rays = 64};
//	struct elements e;
//	struct element_buffers b;
//	struct factors f;
//	struct rays *rays;
//	struct error err;
//	assert(elements_init(&e, &scene->view, &(struct patch_options){.edge = 1}, &err) == STATUS_OK);
//	assert(element_buffers_init(&b, &e, true, device, &err) == STATUS_OK);
//	assert(factors_init(&f, device, e.count, &err) == STATUS_OK);
//	assert(rays_create(device, scene, &plan, &e, &b, &options, &rays, &err) == STATUS_OK);
//	for (uint32_t done = 0; done < e.count;) {
//		uint32_t list[64], n = 0;
//		const uint32_t most = rays_batch(rays, 20000); // rows that take some 20 ms
//		while (n < 64 && n < most && done < e.count)
//			list[n++] = done++;
//		assert(rays_rows(rays, list, n, &f, &err) == STATUS_OK);
//	}
//	for (uint32_t i = 0; i < e.count; i++)
//		assert(f.rows[i].count > 0 || f.rows[i].escaped == 1);
//	rays_destroy(rays);
//	factors_finish(&f);
//	element_buffers_finish(&b, device);
//	elements_finish(&e);
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_RAYS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_RAYS_H

#include "server/worker/plan/plan.h"
#include "server/worker/technique/radiosity/element_buffers.h"
#include "server/worker/technique/radiosity/factors.h"
#include "server/worker/technique/radiosity/ray_table.h"
#include "server/worker/trace/trace.h"
#include "server/worker/vk/pipeline.h"

// Bytes of the rows of a batch, at most, where one row does not take more; near the device's budget they are fewer.
#define RAYS_DENSE_BYTES (64u << 20)
#define RAYS_BOUNCES_MOST 64u

// How rows are made.
struct rays_options {
	uint32_t rays; // of an element: 1 … RAY_TABLE_MOST
	bool mirrors; // rays go on at mirrors; else radiosity_surface is not read
	uint32_t bounces; // at mirrors, that a ray does at most: 0 … RAYS_BOUNCES_MOST
	bool barycentre; // all rays of an element start in its barycentre, in the middles of cells of one form factor, as in
			 // Radiosum; biased near other elements
	enum trace_way traversal;
};

struct rays;

// Device memory that rays_create takes for so many patches and triangles, in bytes, but for what the device rounds up.
uint64_t rays_bytes(uint32_t patches, uint32_t triangles, const struct rays_options *options);

// Make ready: upload what of the scene it needs, the table of rays and the buffers, and make the pipeline. Effects of the
// plan other than those of alpha are left out. The elements and their buffers must outlive it; with mirrors the surfaces
// must have been written before rows are asked for. Fails as buffer_init and pipeline_get; STATUS_BAD_ARGUMENT: options out
// of their ranges. *rays is NULL then.
enum status rays_create(struct device *device, struct resident_scene *scene, const struct plan *plan,
			const struct elements *elements, const struct element_buffers *buffers,
			const struct rays_options *options, struct rays **rays, struct error *err);

// Free it. NULL is allowed.
void rays_destroy(struct rays *rays);

// Run the pipeline once without rays, because some drivers compile at the first run. Not needed, and at once where the
// pipeline has run before. STATUS_MEMORY, STATUS_DEVICE.
enum status rays_compile(struct rays *rays, struct error *err);

// How many rows to ask for next, 1 or more, so that they take about budget_us by what those before them took.
uint32_t rays_batch(const struct rays *rays, double budget_us);

// Trace the rays of `count` elements, at most what rays_batch gives for any budget, and leave the weights in rays_dense.
// STATUS_TRAVERSAL_CUT: the driver ended a loop; STATUS_MEMORY, STATUS_DEVICE. After a failure the dense rows are zero.
enum status rays_trace(struct rays *rays, const uint32_t *elements, uint32_t count, struct error *err);

// What rays_trace made: row k of element elements[k], a word an element, of which rays_unit is a factor of 1; and for each
// row what the row is put with. Whoever takes the rows leaves them zero.
const struct buffer *rays_dense(const struct rays *rays);
double rays_unit(const struct rays *rays);
const struct factors_put *rays_lost(const struct rays *rays);

// Trace the rows and put them into `factors`. Fails as rays_trace and factors_put_dense; then none of them was put.
enum status rays_rows(struct rays *rays, const uint32_t *elements, uint32_t count, struct factors *factors,
		      struct error *err);

// Set the dense rows to zero.
enum status rays_clear(struct rays *rays, struct error *err);

// Put its buffers in their places of binding_set_init's array, which has BIND_MOST: for tests that look at single rays.
void rays_fill(const struct rays *rays, const struct buffer **of);

#endif
