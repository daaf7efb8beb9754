// One request for pictures from many cameras or at many times: its images, how far it is, its account.
//
// progress.c makes a job of each image in turn. There are at most two jobs at a time, the second of them not before the
// first is traced, so that one image is traced while the one before it is encoded and sent. The jobs inherit the sweep's
// place in the schedule: to others it is one long request. The sweep belongs to its jobs and goes with the last of them.
//
// For the files of this folder alone, and for the front's one thread.
#ifndef CANDIL_FRONT_JOBS_SWEEP_H
#define CANDIL_FRONT_JOBS_SWEEP_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "server/front/jobs/schedule.h"
#include "server/front/scenes.h"

#define SWEEP_JOBS 2u // at a time

struct session;

struct sweep {
	struct session *session; // outlives the sweep
	uint32_t request;
	struct subject subject; // held
	candil_Sweep *message; // ours, from malloc
	uint32_t next; // camera that the next job is for
	uint32_t finished; // images that are sent
	unsigned jobs; // that there are now
	bool accepted; // the client has been told
	struct turn turn; // of the job that had the device last
	uint64_t asked_us;
	uint64_t progress_us; // when progress was told last
	uint64_t device_us;
	candil_Done total;
};

// A sweep without jobs. `message` is a checked one from malloc; it is the sweep's on success and the caller's on failure.
// The sweep holds `subject`. NULL: no memory.
struct sweep *sweep_create(struct session *session, uint32_t request, const struct subject *subject, candil_Sweep *message);

// Free it and its message, and give the scenes back. It must have no jobs.
void sweep_destroy(struct sweep *sweep);

// Number of images that were asked for, at least 1.
uint32_t sweep_count(const struct sweep *sweep);

// The request of one image, `index` < sweep_count.
void sweep_frame(const struct sweep *sweep, uint32_t index, candil_Render *render);

// Add the account of an image that is sent to the total.
void sweep_add(struct sweep *sweep, const candil_Done *done);

// All images are sent: make the total what DONE says. `now_us` is clock_us().
void sweep_close(struct sweep *sweep, uint64_t now_us);

// Turn the progress of the images in hand, added up (samples_done, fraction), into that of the whole.
void sweep_progress(const struct sweep *sweep, candil_Progress *progress);

#endif
