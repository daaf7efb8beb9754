// The renders and sweeps that are under way, as the rest of the front sees them: requests come in, the worker's answers come
// in, orders to the worker and replies to the clients go out. A job and its life are described in table.h.
//
// All functions are for the front's one thread (loop.h). They queue replies and orders and never wait. Times are in
// microseconds of clock_us() unless a name says otherwise. `struct job` is for the files of this folder alone.
#ifndef CANDIL_FRONT_JOBS_JOBS_H
#define CANDIL_FRONT_JOBS_JOBS_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "protocol/limits.h"
#include "protocol/names.h"
#include "server/front/compiler.h"
#include "server/front/jobs/room.h"
#include "server/front/loop.h"
#include "server/front/scenes.h"
#include "server/front/worker.h"

struct session;
struct job;

// A frame that a job is about to render, or has rendered, for the length of a call.
struct rendered {
	const struct subject *subject;
	const candil_Render *render; // as it is rendered
	const candil_Done *done; // NULL: not yet
	const struct work *work; // that it has made once for its scene; NULL: not known
	bool alone; // no other job had the device meanwhile
	bool slowed; // something was compiled meanwhile, by the processors that the device is made of
	uint32_t worker; // starts of the worker up to the one that rendered it
};

#define HANDOVER_SIZES 34u // powers of two, of bytes

// What it took lately from reading a job's last image to the last byte sent; zeroed: nothing is known.
struct handover {
	double us, spread; // microseconds: a mean, and how far from it
};

// One of them, in the service. Others may read the figures at its end and `room`.
struct jobs {
	struct worker *worker; // the service's
	uint32_t slice_us; // device time that a slice may take
	struct compiler compilers[LIMIT_COMPILERS]; // kept by compile.c
	uint64_t compiled_us; // when the latest of them ended. Likewise
	struct job *job[LIMIT_JOBS]; // owned; in the order of arrival
	unsigned count;
	uint32_t last_id;
	uint64_t turns; // the schedule's clock
	uint32_t stepping; // id of the job whose STEP is outstanding; the job may be gone by now; 0: none
	uint64_t step_sent_us;
	uint32_t beginning; // the same for BEGIN
	struct subject_hashes stepped_over, begun_over; // what that STEP is about; and that BEGIN
	bool begin_behind_step; // both are outstanding, and the STEP was sent first
	uint32_t held; // id of the job that had the device last; 0: none
	struct room room; // taken by all images together
	unsigned most_images; // that wait beside the first of each connection
	bool short_of_room; // an image waits for common room
	struct handover handovers[TECHNIQUE_COUNT][_candil_Format_ARRAYSIZE][HANDOVER_SIZES]; // kept by deadline.c
	struct loop_timer deadline; // when the next job may have to be given up
	struct loop_timer tick; // when a client is to be told again that the worker is still at it
	uint64_t slices, done, failed, cancelled; // since the start
	uint64_t device_us; // that slices have had, likewise
	bool piloting; // a pilot waits for the device or has it: no STEP and no BEGIN is sent. Kept by the quotes
	bool pilot_out; // the worker has one. Likewise
	// A frame is sent. And what its error is likely to be, if its technique cannot tell. NULL: nobody knows. Set by
	// `owner`.
	void (*rendered)(void *owner, const struct rendered *frame);
	struct estimate (*predict)(void *owner, const struct rendered *frame);
	void *owner;
};

// `jobs` is empty. `worker` must outlive it. `slice_ms` is in milliseconds; `most_images` may wait beside the first one of
// each connection.
void jobs_init(struct jobs *jobs, struct worker *worker, uint32_t slice_ms, unsigned most_images);

// Free all jobs; neither clients nor the worker are told. The worker, the scenes and the sessions must still be there.
void jobs_finish(struct jobs *jobs);

// Queue a request that request_render has checked. The scenes of `subject` are ready or loading; the job
// holds them. `render` is copied. The session gets ERROR or DONE under `request` later. Failures, without a job and without
// a reply: STATUS_TOO_MANY_JOBS, STATUS_MEMORY.
enum status jobs_add(struct jobs *jobs, struct session *session, uint32_t request, const struct subject *subject,
		     const candil_Render *render, struct error *err);

// Hold back the job of a session's request until its technique is chosen. Returns its number; 0: it has none that is not
// begun. A job that could have begun is not failed for its deadline meanwhile, nor after that before it begins.
uint32_t jobs_hold(struct jobs *jobs, const struct session *session, uint32_t request);

// Let the job go on that jobs_hold held, if it is still there, with the choice of `reply`, which is told the client with
// ACCEPTED. `reply` comes from malloc and is taken over; NULL: as it is.
void jobs_decide(struct jobs *jobs, uint32_t id, candil_QuoteReply *reply);

// Is job `id` there and held by jobs_hold?
bool jobs_undecided(const struct jobs *jobs, uint32_t id);

// Is there a job that can be begun, or go on, as soon as the device is free?
bool jobs_want_device(const struct jobs *jobs);

// When the next job, but for job `but` (0: none), has to leave the device for its deadline, which may be over; UINT64_MAX:
// none has to. One that is sent does not count.
uint64_t jobs_first_end_us(const struct jobs *jobs, uint32_t but);

// What jobs under way, but for job `but` (0: none), would add to work of `us` on the device by a session, as far as can be
// foreseen, in its turns with them (schedule.h). *count: how many they are. Nothing for a session that is gone, NULL.
double jobs_queue_us(const struct jobs *jobs, const struct session *session, uint32_t but, double us, uint32_t *count);

// Bytes that the encoded image of a request takes, at most or nearly so.
uint64_t jobs_image_bytes(const candil_Render *render);

// The same for a sweep that request_sweep has checked. `message` comes from malloc. It belongs to the jobs on success and
// stays the caller's on failure.
enum status jobs_add_sweep(struct jobs *jobs, struct session *session, uint32_t request, const struct subject *subject,
			   candil_Sweep *message, struct error *err);

// The job of a session's request, NULL if it has none. A sweep has several jobs, and one of them is returned. The pointer is
// good until the next call that may end jobs.
struct job *jobs_find(struct jobs *jobs, const struct session *session, uint32_t request);

// Have shader code, a number that the worker gave, compiled for a peer (peer.h) by a process of its own (compile.h):
// `pilot_us` as of compiler_start. False: no place is free, or none that this peer may have: ask again later. And is it
// under way?
bool jobs_compile(struct jobs *jobs, uint64_t peer, uint64_t code, const struct subject *subject,
		  const candil_Render *render, uint32_t pilot_us);
bool jobs_compiling(const struct jobs *jobs, uint64_t code);

// End a job with an error to its client. A job of a sweep takes the whole sweep along, so several jobs may go and others
// change places in the table. `err` NULL: the client is gone, and nobody is told. A slice that is under way is not cut
// short: the device is free after it.
void jobs_fail(struct jobs *jobs, struct job *job, const struct error *err);

// The same for all jobs of a session; of everybody if `session` is NULL.
void jobs_fail_all(struct jobs *jobs, const struct session *session, const struct error *err);

// The same for all jobs that use a scene.
void jobs_fail_scene(struct jobs *jobs, const struct scene *scene, const struct error *err);

// Fail all jobs over what is quarantined.
void jobs_fail_quarantined(struct jobs *jobs, const struct quarantine *quarantine);

// How many jobs use a scene, whatever part it has in them.
uint32_t jobs_using(const struct jobs *jobs, const struct scene *scene);

// End the jobs whose deadline has come and give the worker what it can take now: READ, STEP, BEGIN. The service calls it
// once after each batch of events.
void jobs_dispatch(struct jobs *jobs);

// Queue a piece of the images of a session's jobs, the oldest job's first, and end the jobs whose last byte is queued. True
// if something was queued or a job ended. Nothing is queued while session_has_room says no. An image that cannot be read
// back ends its job with STATUS_INTERNAL.
bool jobs_fill(struct jobs *jobs, struct session *session);

// The worker's answers to BEGIN, STEP and READ for the job `id`, which may have ended since. The worker's owner has cleaned
// their strings and checked their counts; their `error` says how it went, and an error ends the job, unless it lacks memory
// that another job has. `fd` is the image's sealed memfd and is taken over; -1 if there is none.
void jobs_begun(struct jobs *jobs, uint32_t id, const struct ipc_begun *begun);
void jobs_stepped(struct jobs *jobs, uint32_t id, const struct ipc_stepped *stepped);
void jobs_image(struct jobs *jobs, uint32_t id, const struct ipc_image *image, int fd);

// The worker is gone with everything that it had of the jobs, which wait for the next one. One job is blamed and fails with
// STATUS_WORKER_LOST if it was blamed more than LIMIT_JOB_RETRIES times. If the loss is hopeless, all jobs that wait fail.
void jobs_worker_lost(struct jobs *jobs, const struct worker_loss *loss);

// What the worker carries out an order about, a STEP, BEGIN or READ, even if its job has ended since; empty: nothing, as far
// as is known.
struct subject_hashes jobs_worked_on(const struct jobs *jobs);

#endif
