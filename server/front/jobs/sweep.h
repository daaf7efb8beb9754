// One request for pictures from many cameras or at many times: its images, how far it is, its account. jobs.c makes a job of
// each in turn: at most two at a time, the second not before the first is traced, so that one image is traced while the one
// before it is encoded and sent. The jobs inherit the sweep's place in the schedule: to others it is one long request. The
// sweep belongs to its jobs and goes with the last of them; it holds the scene meanwhile.
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
	struct session *session;
	uint32_t request;
	struct scene *scene; // held
	struct scene *environment; // held; NULL: none
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

// `message` is a checked one from malloc; it is the sweep's on success and the caller's on failure (NULL: no memory).
struct sweep *sweep_create(struct session *session, uint32_t request, struct scene *scene, struct scene *environment,
			   candil_Sweep *message);
void sweep_destroy(struct sweep *sweep);

uint32_t sweep_count(const struct sweep *sweep);

// The request of one image.
void sweep_frame(const struct sweep *sweep, uint32_t index, candil_Render *render);

// Add the account of a finished image, `samples` and all, to the total. sweep_close makes the total what DONE says.
void sweep_add(struct sweep *sweep, const candil_Done *done);
void sweep_close(struct sweep *sweep, uint64_t now_us);

// Turn the progress of the images in hand, added up (samples_done, fraction), into that of the whole.
void sweep_progress(const struct sweep *sweep, candil_Progress *progress);

#endif
