// What the daemon knows of times and errors: the model, its file, and what its worker has compiled and built by now. Frames
// that jobs render and pilots go in; quotes ask.
//
// For the front's one thread (loop.h). A request is told by a struct rendered whose `done` is not read.
#ifndef CANDIL_FRONT_QUOTES_KNOWN_H
#define CANDIL_FRONT_QUOTES_KNOWN_H

#include "server/front/jobs/jobs.h"
#include "server/front/quotes/model.h"
#include "server/front/quotes/store.h"

#define QUOTE_LOST 64u // that a worker was lost with, likewise
#define QUOTE_WORKS 64u // what was told of work, likewise
#define QUOTE_WARM 512u // kinds of programs, and of what is made of a scene, that are remembered to be there, the latest

// Others may read it, and set warm_count to 0 when the worker is lost.
struct quote_known {
	const struct worker *worker;
	struct quote_model *model; // owned
	struct quote_store store;
	uint64_t stamp; // of the newest record
	uint64_t warm[QUOTE_WARM];
	uint32_t warm_count; // ever
	uint32_t begun; // techniques that made something warm, bits 1 << candil_Technique; nothing if warm_count is 0
	struct quote_work {
		uint64_t what; // it is about
		struct work work;
	} works[QUOTE_WORKS];
	uint32_t work_count; // ever
	uint32_t works_of; // starts of the worker that told them
	uint64_t lost[QUOTE_LOST];
	uint32_t lost_count; // ever
};

// Read what the file of `state` (a folder; "": none is kept) knows, and have the jobs hand their frames here. `jobs` and
// `worker` must outlive it, and so must `known` the jobs' frames. Failure: STATUS_MEMORY.
enum status quote_known_init(struct quote_known *known, struct jobs *jobs, const struct worker *worker, const char *state,
			     struct error *err);

// Write what is new to the file, and free all. A zeroed one is fine.
void quote_known_finish(struct quote_known *known);

// The key of a request by a technique, whether what it needs is compiled and built, and what to ask the model. Programs
// depend on what scenes have, so those of another scene with the same facts are compiled, too. Of a technique that has work
// to be made once for a scene, `work` is what a worker told of it; NULL, or untold: what was told before, else it may be
// anything.
struct quote_key quote_known_key(const struct quote_known *known, const struct rendered *f, candil_Technique technique);
bool quote_known_warm(const struct quote_known *known, const struct rendered *f, const struct quote_key *key);
struct quote_query quote_known_query(const struct quote_known *known, const struct rendered *f, candil_Technique technique,
				     uint32_t samples, const struct work *work);

// Whether the worker was lost with a pilot of such a request by that technique. And remember that it was.
bool quote_known_lost(const struct quote_known *known, const struct rendered *f, const struct quote_key *key);
void quote_known_bar(struct quote_known *known, const struct rendered *f, candil_Technique technique);

// The techniques, bits 1 << candil_Technique, that could not render the scene of a request when it was looked at last.
uint32_t quote_known_refused(const struct quote_known *known, const struct rendered *f);

// Remember what a worker told of a technique's work for a request, and tell the best that is known of it by then: of what is
// counted alone, what was tried out before.
struct work quote_known_told(struct quote_known *known, const struct rendered *f, candil_Technique technique,
			     const struct work *work);

// Learn what a pilot of that request says of a technique: one that is refused, that it could not render it, and one without
// pixels what its work takes alone.
void quote_known_pilot(struct quote_known *known, const struct rendered *f, candil_Technique technique,
		       const struct pilot_result *result);

#endif
