// The life of a render, from the request that was checked to its last byte.
//
//   WAITING ─ scene there, worker ready ─> BEGINNING ─> ACTIVE ─ all samples in ─> FINISHED ─ may be read ─> READING ─>
//   SENDING
//      ^                                       │           │                           │                       │
//      └────────────── the worker was lost ────┴───────────┴───────────────────────────┴───────────────────────┘
//
// A FINISHED job keeps its accumulators on the device until there is room for its image (room.h): for as long as its client
// has too much to take, or all clients together have and the image is a large one. An ACTIVE one that lacks memory while
// others have some waits for one of them to end, and begins again.
#ifndef CANDIL_FRONT_JOBS_JOBS_H
#define CANDIL_FRONT_JOBS_JOBS_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "protocol/limits.h"
#include "server/front/jobs/image.h"
#include "server/front/jobs/room.h"
#include "server/front/jobs/schedule.h"
#include "server/front/jobs/sweep.h"
#include "server/front/loop.h"
#include "server/front/scenes.h"
#include "server/front/worker.h"

struct session;

enum job_state { JOB_WAITING, JOB_BEGINNING, JOB_ACTIVE, JOB_FINISHED, JOB_READING, JOB_SENDING };

struct job {
	uint32_t id; // between front and worker; never 0
	enum job_state state;
	struct session *session;
	uint32_t request;
	struct sweep *sweep; // that it is an image of; NULL: a render
	uint32_t index; // of its camera
	struct scene *scene; // held
	struct scene *environment; // held; NULL: none
	candil_Render render;
	struct turn turn;
	bool accepted; // the client has been told
	bool short_of_memory; // begins again when another job has ended
	unsigned refusals; // for want of memory
	unsigned blames; // workers that were lost while it held them
	uint32_t retries; // times it was begun again after a loss
	uint32_t slices;
	uint32_t samples_done;
	double fraction;
	double estimated_relmse; // negative: unknown
	uint64_t deadline_us; // when its image should be there; UINT64_MAX: never
	bool late; // it ends for that
	bool reached; // it ends for its target error
	uint64_t read_us; // when its last image was asked for
	uint64_t device_us;
	uint64_t asked_us, begun_us; // begun_us: the first BEGIN; 0: none yet
	uint64_t progress_us; // when progress was told last
	bool preview_due; // asked of the worker, not here yet
	uint32_t preview_samples; // of the last one asked for
	uint64_t preview_us;
	struct image preview, final;
	candil_Done done; // the worker's part
};

struct jobs {
	struct worker *worker;
	uint32_t slice_us;
	struct job *job[LIMIT_JOBS]; // in the order of arrival
	unsigned count;
	uint32_t last_id;
	uint64_t turns; // the schedule's clock
	uint32_t stepping; // job with a STEP outstanding, perhaps gone by now; 0: none
	uint64_t step_sent_us;
	uint32_t beginning; // the same for BEGIN
	bool begin_behind_step; // both are outstanding, the STEP was sent first
	uint32_t held; // job that had the device last
	struct room room; // of all images
	bool short_of_room; // an image waits for common room
	double encode_us; // a byte of an image's estimate: what reading and encoding took lately
	struct loop_timer deadline; // the next of a job that waits
	uint64_t slices, done, failed, cancelled;
};

void jobs_init(struct jobs *jobs, struct worker *worker, uint32_t slice_ms);
void jobs_finish(struct jobs *jobs);

// Queue a checked request. The scene is ready or loading, and so is the picture of its surroundings (NULL: none).
// STATUS_TOO_MANY_JOBS, STATUS_MEMORY.
enum status jobs_add(struct jobs *jobs, struct session *session, uint32_t request, struct scene *scene,
		     struct scene *environment, const candil_Render *render, struct error *err);

// The same for a sweep. `message` is from malloc and the jobs' on success.
enum status jobs_add_sweep(struct jobs *jobs, struct session *session, uint32_t request, struct scene *scene,
			   struct scene *environment, candil_Sweep *message, struct error *err);

// The job of a request; of a sweep, one of its jobs: there is always one.
struct job *jobs_find(struct jobs *jobs, const struct session *session, uint32_t request);

// End a job, and the sweep that it is of, with an error to its client; the device is free after the slice that is under way.
void jobs_fail(struct jobs *jobs, struct job *job, const struct error *err);

// End all jobs of a connection, or of everybody (session NULL). err NULL: nobody is told.
void jobs_fail_all(struct jobs *jobs, const struct session *session, const struct error *err);
void jobs_fail_scene(struct jobs *jobs, const struct scene *scene, const struct error *err);

// Number of jobs that use a scene, as one or for their surroundings.
uint32_t jobs_using(const struct jobs *jobs, const struct scene *scene);

// Give the worker what it can take now: begin, read, step. Called from settle.
void jobs_dispatch(struct jobs *jobs);

// Queue a piece of a session's images; ends the jobs that are all sent. True if something was queued.
bool jobs_fill(struct jobs *jobs, struct session *session);

// The worker's answers.
void jobs_begun(struct jobs *jobs, uint32_t id, const struct ipc_begun *begun);
void jobs_stepped(struct jobs *jobs, uint32_t id, const struct ipc_stepped *stepped);
void jobs_image(struct jobs *jobs, uint32_t id, const struct ipc_image *image, int fd);
void jobs_worker_lost(struct jobs *jobs, const char *how, bool hopeless);

#endif
