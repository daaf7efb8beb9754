// A job of the worker: a request's plan over a resident scene, and the technique that is at work on it.
//
// Device's thread only. Functions that return enum status fill `err` on failure, as those of technique.h do.
#ifndef CANDIL_WORKER_JOB_H
#define CANDIL_WORKER_JOB_H

#include "server/base/ipc.h"
#include "server/worker/attempts.h"
#include "server/worker/plan/plan.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/technique/technique.h"

// What all jobs share.
struct stock {
	struct devices *devices;
	struct error no_device; // why devices->vk is NULL, if it is
	struct resident_scenes scenes;
};

// A job.
struct job {
	struct job *next;
	uint32_t id;
	candil_Render request; // whose words go into the files
	struct plan plan;
	struct resident_scene *scene;
	struct resident_scene *environment; // the picture of the surroundings; NULL: none
	struct resident_scene *imported; // the file that is imported; NULL: none
	const struct technique *technique;
	struct attempts attempts; // at its picture
	uint64_t edit_us; // that its edits took; 0: none, or made before
	uint64_t open_us; // that opening a device took for it
	uint64_t preview_us; // that reading intermediate images took
	uint64_t work_us; // all that this thread spent on it, on the device or beside it
	bool compile; // what its code needs is compiled whenever it is met
};

// Begin what the front orders, in a zeroed job. On failure job_destroy gives back what was taken.
enum status job_begin(struct stock *stock, const struct ipc_begin *order, struct job *job, struct error *err);

// Take hold of what a request is about, likewise, and of nothing else.
enum status job_acquire(struct stock *stock, const uint64_t ids[PARTS], const candil_Render *render, struct job *job,
			struct error *err);

// What the client is told of a job that is begun.
void job_accept(const struct stock *stock, const struct job *job, candil_Accepted *accepted);

// Work on it (technique.h's `step`).
enum status job_step(struct stock *stock, struct job *job, uint32_t budget_us, struct step_result *result,
		     struct error *err);

// The code for want of which the job was refused; 0: that is not why it failed. It is begun again, and then tells what its
// edits took.
uint64_t job_refused_for(const struct stock *stock, const struct job *job);

// End it, wherever it stands, and free it. NULL is allowed.
void job_destroy(struct stock *stock, struct job *job);

// Begin a job and take the steps in which code is compiled, which fills the driver's cache. What goes wrong goes wrong again
// where somebody is told.
void job_compile(struct stock *stock, const struct ipc_begin *order);

// Is code that was never compiled compiled when it is met, from here on? Else what needs it is refused, and
// devices->code.refused says which.
void stock_allow_compiling(struct stock *stock, bool at_will);

// Bytes of the budget that are free once everything that no job needs has made room.
uint64_t stock_left(const struct stock *stock);

// After STATUS_MEMORY: evict scenes that no job uses, the one unused for longest first. Evict nothing if it would not help.
bool stock_make_room(struct stock *stock);

#endif
