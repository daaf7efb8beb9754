// candil-worker, seen from the front: a process that may die at any time and is then started again, with every scene.
//
// Orders never wait: what the worker's socket does not take is kept here, in order. At most one STEP and one BEGIN are
// outstanding; the jobs see to that. A watchdog kills a worker that hangs: with an order to answer it is still for a while
// (as pulse.h has it), or works on one order, or on one image, without an end. Slow it may be: neither bound is one of the
// clock. After a loss the next worker starts after a pause that doubles with each loss, until a slice is done.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_WORKER_H
#define CANDIL_FRONT_WORKER_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/ipc.h"
#include "server/front/child.h"
#include "server/front/device_losses.h"
#include "server/front/options.h"
#include "server/front/parcels.h"
#include "server/front/subject.h"
#include "server/front/watch.h"

// Whose fault a loss is, as far as its end tells.
enum worker_fault {
	FAULT_NONE, // it was ended from outside, or did not start, or spoke nonsense
	FAULT_WORK, // it crashed or hung: what it worked on may be why, or the device's driver
	FAULT_DEVICE, // its driver says that the device was lost
};

struct worker_loss {
	const char *how; // it ended, in words
	enum worker_fault fault;
	bool hopeless; // it has failed to become ready several times in a row
};

// Calls from the worker to its owner, all from the loop and none from within an order. Of every answer the strings are clean
// and the counts within bounds; it is good for the length of the call. `job` is the number that the order had.
struct worker_events {
	// A new worker is ready and knows nothing: give it the scenes.
	void (*ready)(void *owner);

	// The answer to BEGIN; begun->error says if the job was accepted.
	void (*begun)(void *owner, uint32_t job, const struct ipc_begun *begun);

	// The answer to STEP; stepped->error says how it went.
	void (*stepped)(void *owner, uint32_t job, const struct ipc_stepped *stepped);

	// The answer to READ. `fd` is a sealed memfd of image->frame.bytes bytes and becomes the owner's; negative if there
	// is none, and image->error says why.
	void (*image)(void *owner, uint32_t job, const struct ipc_image *image, int fd);

	// The answer to PILOT; `pilot` is the number that the order had.
	void (*piloted)(void *owner, uint32_t pilot, const struct ipc_piloted *piloted);

	// The worker is gone with all its jobs and scenes, and no answer will come.
	void (*lost)(void *owner, const struct worker_loss *loss);
};

enum worker_state { WORKER_DOWN, WORKER_STARTING, WORKER_READY };

// Others may read `state`, `loop`, `options`, child.pid and the figures at the end.
struct worker {
	struct loop *loop;
	struct children *children;
	const struct options *options;
	const struct worker_events *events;
	void *owner;
	enum worker_state state;
	struct child child;
	struct loop_timer restart, again;
	struct watch watch; // while an answer or an image is due
	struct parcels waiting; // orders that its socket has not taken
	bool crowded; // the first of them because too many descriptors of the user are on their way
	uint8_t *inbox; // IPC_MAX_BYTES
	unsigned answers_due; // of BEGIN and STEP
	unsigned images_due;
	uint32_t pilot; // number of the PILOT without an answer; 0: none
	bool holding; // it has that PILOT: it is sent nothing but the pilot's end, which it can then see at once
	uint64_t quiet_us; // since when it owes one, and has given none
	uint64_t answer_work_us; // that it has worked since the last answer, or since an answer is due
	uint64_t image_work_us; // the same for images
	const char *killed_for; // why the front killed it; NULL: it did not
	enum worker_fault fault; // FAULT_NONE: its end tells
	struct error device_lost; // code != OK: it says so
	unsigned failures; // losses since the last slice that was done
	unsigned failed_starts; // in a row
	// for stats
	uint32_t starts;
	struct ipc_ready ready; // what the latest said as it became so; zeroed: none has
	struct device_losses losses;
	struct ipc_state held; // as it said last
};

// The first worker starts as soon as the loop runs; if it cannot be started, that is a loss like any other. `children`,
// `options`, `events` and `owner` must outlive it. Failure: STATUS_MEMORY.
enum status worker_init(struct worker *worker, struct children *children, const struct options *options,
			const struct worker_events *events, void *owner, struct error *err);

// Kill it and start none again. No event is called. May be called twice.
void worker_finish(struct worker *worker);

// The loss that `lost` tells of is its device's. True: that was one too many, and the next worker takes another device, if
// there is one.
bool worker_blame_device(struct worker *worker);

// What replies are to tell of devices that were lost, in a sentence; "": nothing.
void worker_device_note(const struct worker *worker, char note[LIMIT_TEXT + 1]);

// Orders. They are ignored unless the worker is WORKER_READY, and none fails: a worker that an order cannot reach is killed,
// and `lost` follows from the loop. The scenes of a `subject` were given to it.

// Know this scene: `blob`, a sealed memfd, stays the caller's, who says worker_forget before closing it.
void worker_scene(struct worker *worker, uint64_t scene, int blob);

// Forget it once no job uses it any more.
void worker_forget(struct worker *worker, uint64_t scene);

// Begin a job under a number that no job has; `begun` answers. `end_us`, `compile`: as of struct ipc_begin.
void worker_begin(struct worker *worker, uint32_t job, const struct subject *subject, const candil_Render *render,
		  uint64_t end_us, bool compile);

// Work on a job for about budget_us of device time; `stepped` answers.
void worker_step(struct worker *worker, uint32_t job, uint32_t budget_us);

// Look at a scene as `pilot` says; `piloted` answers under its number, head.job. No STEP, no BEGIN and no PILOT may be
// outstanding.
void worker_pilot(struct worker *worker, const struct ipc_pilot *pilot);

// End the pilot that is out before its time; `piloted` answers with what it has seen, unless it has answered already. What
// cannot be cut short, such as compiling, is waited for. False: it cannot be told now, and the pilot takes its time.
bool worker_pilot_end(struct worker *worker);

// Encode the job's picture as it is, `final` for the last time, which ends the job; `image` answers. `predicted`: as of
// struct ipc_read.
void worker_read(struct worker *worker, uint32_t job, bool final, const struct estimate *predicted);

// Since when it has owed an answer without giving any; UINT64_MAX: it owes none.
uint64_t worker_quiet_us(const struct worker *worker);

// Free what it has of a job, after the orders that went before. There is no answer.
void worker_end(struct worker *worker, uint32_t job);

// How a worker is started: the program, and its device and budget.
struct worker_command {
	char program[PATH_MAX], device[128], budget[16], taken[24];
	char *argv[9 + 2 * DEVICES_AVOIDED]; // into this struct, the worker and static storage; ended by NULL
};

// The command of this worker; `compile`: of a process that compiles for it (compiler.h). STATUS_INTERNAL: a path is too
// long.
enum status worker_command(struct worker *worker, bool compile, struct worker_command *command, struct error *err);

// Is this signal one that a process brings upon itself, by a crash?
bool worker_is_own_fault(int signal_number);

// Seconds that it, or a process that compiles for it, may be still before it counts as hung.
unsigned worker_patience_s(const struct worker *worker);

#endif
