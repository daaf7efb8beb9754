// candil-worker, seen from the front: a process that may die at any time and is then started again, with every scene.
//
// Orders never block: what its socket does not take waits here, in order. At most one STEP and one BEGIN are outstanding
// (the jobs see to that); the watchdog kills a worker that leaves one, or an image, unanswered for too long. After a loss
// the next one starts after a pause that doubles with each loss until a slice is done.
#ifndef CANDIL_FRONT_WORKER_H
#define CANDIL_FRONT_WORKER_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/ipc.h"
#include "server/front/child.h"
#include "server/front/options.h"
#include "server/front/parcels.h"

// Calls from the worker to its owner.
struct worker_events {
	// A new worker is ready and knows nothing: give it the scenes.
	void (*ready)(void *owner);
	void (*begun)(void *owner, uint32_t job, const struct ipc_begun *begun);
	void (*stepped)(void *owner, uint32_t job, const struct ipc_stepped *stepped);
	// `fd`: sealed memfd of image->frame.bytes bytes, the callee's; -1 if image->error says why there is none.
	void (*image)(void *owner, uint32_t job, const struct ipc_image *image, int fd);
	// It is gone with all its jobs. `how` in words. `hopeless`: it has failed to become ready several times in a row.
	void (*lost)(void *owner, const char *how, bool hopeless);
};

enum worker_state { WORKER_DOWN, WORKER_STARTING, WORKER_READY };

struct worker {
	struct loop *loop;
	struct children *children;
	const struct options *options;
	const struct worker_events *events;
	void *owner;
	enum worker_state state;
	struct child child;
	struct loop_timer restart, watchdog;
	struct parcels waiting; // orders that its socket has not taken
	uint8_t *inbox; // IPC_MAX_BYTES
	unsigned answers_due; // of BEGIN and STEP
	unsigned images_due;
	uint64_t answer_wait_us; // since when the oldest of them is worked on
	uint64_t image_wait_us;
	const char *killed_for; // why we killed it; NULL: we did not
	unsigned failures; // losses since the last slice that was done
	unsigned failed_starts; // in a row
	// for stats
	uint32_t starts;
	char device[128];
	struct error device_error; // code != OK: no usable device
	uint64_t device_bytes;
	uint64_t validation_errors;
};

// The worker is started at once, or its first attempt's failure handled as a loss.
enum status worker_init(struct worker *worker, struct children *children, const struct options *options,
			const struct worker_events *events, void *owner, struct error *err);

// Kill it. No event is called.
void worker_finish(struct worker *worker);

// Orders. Ignored unless it is ready.
void worker_scene(struct worker *worker, uint64_t scene, int blob);
void worker_forget(struct worker *worker, uint64_t scene);
void worker_begin(struct worker *worker, uint32_t job, uint64_t scene, uint64_t environment, const candil_Render *render);
void worker_step(struct worker *worker, uint32_t job, uint32_t budget_us);
void worker_read(struct worker *worker, uint32_t job, bool final);
void worker_end(struct worker *worker, uint32_t job);

#endif
