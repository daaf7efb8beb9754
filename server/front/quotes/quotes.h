// Quotes: what a render would take and how good it would be, and the choice of TECHNIQUE_AUTO. A quote of a view that is not
// known is answered after a pilot in the worker; if that is not back in QUOTE_PATIENCE_MS, from what is known. What pilots
// and frames tell is kept in the model (model.h) and in a file (store.h).
//
// For the front's one thread (loop.h). Replies are queued, nothing waits.
#ifndef CANDIL_FRONT_QUOTES_QUOTES_H
#define CANDIL_FRONT_QUOTES_QUOTES_H

#include "server/front/quotes/known.h"

struct quote; // one that is under way

// One of them, in the service.
struct quotes {
	struct jobs *jobs;
	struct worker *worker;
	struct quote_known known;
	struct quote *first; // owned; in the order of arrival
	unsigned count;
	uint32_t last_id;
	uint32_t out; // id of the quote whose pilot the worker has; 0: none
	uint64_t out_since_us;
	bool ending; // the worker was told to end it
	uint64_t owed_us; // no pilot is sent before the jobs have had so much of the device in all
};

// No quote yet; what the file of `state` (a folder; "": none is kept) knows is read. `jobs` and `worker` must outlive it,
// and jobs->rendered is set. Failure: STATUS_MEMORY.
enum status quotes_init(struct quotes *quotes, struct jobs *jobs, struct worker *worker, const char *state,
			struct error *err);

// Write the file, if there is anything new, and free all. Nobody is told. A zeroed one is fine.
void quotes_finish(struct quotes *quotes);

// Answer a checked Quote, now or later. The scenes of `subject` are ready or loading, and are held meanwhile.
// `quote` is copied. The session gets QUOTE_REPLY or ERROR under `request`. Failures, without a reply: STATUS_BAD_ARGUMENT
// (no technique can), STATUS_TOO_MANY_JOBS, STATUS_MEMORY.
enum status quotes_add(struct quotes *quotes, struct session *session, uint32_t request, const struct subject *subject,
		       const candil_Quote *quote, struct error *err);

// Choose for the job that a session's request has just become, which is of TECHNIQUE_AUTO with a target error or a deadline.
// If that cannot be, the job goes on as it is.
void quotes_choose(struct quotes *quotes, struct session *session, uint32_t request, const struct subject *subject,
		   const candil_Render *render);

// Whether a session's request is a quote under way.
bool quotes_find(const struct quotes *quotes, const struct session *session, uint32_t request);

// End a session's quote, which there is, with an error.
void quotes_cancel(struct quotes *quotes, const struct session *session, uint32_t request, const struct error *err);

// A session is gone: nobody is told of its quotes. A scene could not be loaded: its quotes end with `err`. Everything ends:
// all do, and none holds a scene any more.
void quotes_drop_session(struct quotes *quotes, const struct session *session);
void quotes_fail_scene(struct quotes *quotes, const struct scene *scene, const struct error *err);
void quotes_fail_all(struct quotes *quotes, const struct error *err);

// What the worker looks at in a pilot. False: it has none.
bool quotes_worked_on(const struct quotes *quotes, struct subject_hashes *suspects);

// Fail the quotes about what is quarantined.
void quotes_fail_quarantined(struct quotes *quotes, const struct quarantine *quarantine);

// Answer what can be answered and send the next pilot. The service calls it after each batch of events, before
// jobs_dispatch.
void quotes_dispatch(struct quotes *quotes);

// The worker's answer to PILOT, and its end; `hopeless`: no other comes up, and all are answered from what is known.
void quotes_piloted(struct quotes *quotes, uint32_t id, const struct ipc_piloted *piloted);
void quotes_worker_lost(struct quotes *quotes, bool hopeless);

#endif
