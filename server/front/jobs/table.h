// The table of jobs: what a job is, who is in the table, how a job comes in and goes. The other files of this folder stand
// on it, and it calls none of them but room, image and sweep.
//
// The life of a job, from the request that was checked to its last byte:
//
//   WAITING ─ scene there, worker ready ─> BEGINNING ─> ACTIVE ─ all samples in ─> FINISHED ─ may be read ─> READING ─>
//   SENDING
//      ^                                       │           │                           │                       │
//      └────────────── the worker was lost ────┴───────────┴───────────────────────────┴───────────────────────┘
//
// A FINISHED job keeps its accumulators on the device until there is room for its image (room.h): for as long as its client
// has too much to take, or as all clients together have and the image is a large one. An ACTIVE job that lacks memory which
// other jobs have waits until one of them ends, and begins again.
//
// For the files of this folder alone, and for the front's one thread.
#ifndef CANDIL_FRONT_JOBS_TABLE_H
#define CANDIL_FRONT_JOBS_TABLE_H

#include "server/front/jobs/image.h"
#include "server/front/jobs/jobs.h"
#include "server/front/jobs/schedule.h"

struct sweep;

enum job_state { JOB_WAITING, JOB_BEGINNING, JOB_ACTIVE, JOB_FINISHED, JOB_READING, JOB_SENDING };

struct job {
	uint32_t id; // between front and worker; never 0
	enum job_state state;
	struct session *session; // outlives the job
	uint32_t request;
	struct sweep *sweep; // that it is an image of; goes with the last of its jobs; NULL: a render
	uint32_t index; // of its camera
	struct subject subject; // held
	candil_Render render;
	struct turn turn;
	bool accepted; // the client has been told
	bool undecided; // its technique is being chosen: it is not begun before
	candil_QuoteReply *quote; // owned: what its technique was chosen by; NULL: nobody chose
	bool crowded; // others had the device, too
	uint64_t code; // that the worker refused it for (compile.h); 0: none
	bool compiling; // it waits for that code: it is not begun before
	bool compile; // the worker compiles what it needs
	uint64_t cold_us; // when the BEGIN was sent that was refused for it; 0: none, or it is begun again since
	uint64_t compiled_us; // from such a BEGIN to the next one, all together
	bool short_of_memory; // begins again when another job has ended
	unsigned refusals; // for want of memory
	unsigned blames; // workers that were lost while they had it
	uint32_t retries; // times it was begun again after a loss
	uint32_t slices;
	uint32_t samples_done;
	bool ready; // there is a picture to read
	double fraction; // of the work, 0 to 1
	struct estimate estimate; // of its error, at the last look
	struct estimate predicted; // of its error, where nothing measures it
	uint64_t deadline_us; // when the last byte of its image should be sent; UINT64_MAX: never
	uint64_t end_us; // when sampling has to end for that
	bool spared; // a quote or a pilot kept it from beginning: its deadline does not fail it before
	bool late; // it ends because of its deadline
	bool scaled; // its picture is made of fewer pixels than were asked for
	bool reached; // it ends because its target error is reached
	uint64_t read_us; // when its last image was asked for
	uint64_t device_us; // that it had
	uint64_t asked_us, begun_us; // begun_us: the first BEGIN; 0: none yet
	uint64_t again_us; // the latest BEGIN
	uint32_t worker; // starts of the worker up to then
	uint64_t encoded_us; // when the final image came
	uint64_t progress_us; // when progress was told last
	bool preview_due; // asked of the worker, not here yet
	uint32_t preview_samples; // of the last preview that was asked for
	uint64_t preview_us; // when that was
	struct image preview, final;
	struct image last; // the latest preview that is all sent, where a deadline may make it the final one
	candil_Done done; // the worker's part
	struct work work; // that the job has made once for its scene
};

// The job with a number. NULL: it has ended.
struct job *jobs_by_id(const struct jobs *jobs, uint32_t id);

// A number that no job has. Never 0.
uint32_t jobs_new_id(struct jobs *jobs);

// Does the worker hold memory of the device for it?
bool job_on_device(const struct job *job);

// Is it the first of its sweep's jobs? The images of a sweep are sent in order, so only the first job may ask for room: a
// later one could take the room that the first needs. A render is always first.
bool job_is_first(const struct jobs *jobs, const struct job *job);

// May a peer with the session's jobs have one more? Failure: STATUS_TOO_MANY_JOBS.
enum status jobs_may_add(const struct jobs *jobs, const struct session *session, struct error *err);

// Put a job at the end of the table: WAITING, with its arrival as of now, holding `subject`. The caller fills in `render`
// and the deadline. Failures: STATUS_TOO_MANY_JOBS, STATUS_MEMORY.
enum status job_create(struct jobs *jobs, struct session *session, uint32_t request, const struct subject *subject,
		       struct job **out, struct error *err);

// Take a job out of the table and free it, and its sweep if it is the last of it; the worker gets END if it has the job. The
// client is told nothing. Jobs behind it move up.
void job_drop(struct jobs *jobs, struct job *job);

// Free all jobs; neither clients nor the worker are told.
void jobs_clear(struct jobs *jobs);

// Device memory is free, or about to be: jobs that lacked some may try again.
void jobs_let_others_try(struct jobs *jobs);

// Whose room its images take.
struct room_owner job_room(struct jobs *jobs, const struct job *job);

// Close one of the job's two images, if there is one, and give its room back, if it has some.
void job_release_image(struct jobs *jobs, const struct job *job, struct image *image);

// A line in the log: what the job was and what it took. `how` it ended, in a word or two.
void job_log_end(const struct job *job, const char *how);

#endif
