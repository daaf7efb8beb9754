// A process that compiles the shader code of one job, so that the worker can go on with others: code that no driver has seen
// before takes seconds, on a busy machine minutes. It is candil-worker once more, run with --compile: it gets the scene and
// the job, begins it, and exits when all code is compiled. What comes of it is the driver's cache, where the worker then
// finds the code. One that was ended from outside, or found no memory, has compiled nothing, and the worker compiles for
// itself.
//
// What it takes of the device has a bound: one part in LIMIT_COMPILERS of what the worker leaves of the memory budget when
// it starts. The worker may take that, too, while it compiles, so that all together may have nearly twice the budget. Its
// picture is the least that needs the same code, so that it seldom takes much.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_COMPILER_H
#define CANDIL_FRONT_COMPILER_H

#include <stdint.h>

#include "server/front/child.h"
#include "server/front/scenes.h"
#include "server/front/worker.h"

// It has ended. `code` is the number that it was started with. `failure` NULL: it may have compiled that; else the driver
// crashes over it or works on it without an end, and would do so in the worker: the words say which. Not called from within
// the functions below.
typedef void compiler_done(void *owner, uint64_t code, const char *failure);

struct compiler {
	struct worker *worker; // whose device it compiles for
	struct child child;
	struct watch watch;
	uint64_t work_us; // since its start
	uint64_t code; // what it compiles: a number that the worker gave (ipc.h); 0: nothing, it is free
	uint64_t peer; // for whom (peer.h); for its owner to set and to read
	compiler_done *done;
	void *owner;
};

// `worker` and `owner` must outlive it.
void compiler_init(struct compiler *compiler, struct worker *worker, compiler_done *done, void *owner);

// Start it for a job, or for a pilot by the technique of `render` with so much work, `pilot_us`, which is then not 0: a
// pilot's pictures are of other sizes. `code` is not 0, and the scenes of `subject` are loaded. It must be free.
// Failure, and it is free: STATUS_INTERNAL, STATUS_IO.
enum status compiler_start(struct compiler *compiler, uint64_t code, const struct subject *subject,
			   const candil_Render *render, uint32_t pilot_us, struct error *err);

// Kill it; `done` is not called. Nothing if it is free.
void compiler_stop(struct compiler *compiler);

#endif
