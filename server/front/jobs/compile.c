#include "server/front/jobs/compile.h"

#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/front/peer.h"
#include "server/front/session.h"
#include "server/front/share.h"

void job_compile_first(struct job *job, uint64_t code)
{
	job->compile = job->code == code;
	if (job->compile)
		log_line(LOG_INFO, "job %u: the worker compiles %016llx", job->id, (unsigned long long)code);
	job->compiling = !job->compile;
	job->code = code;
	job->cold_us = job->again_us;
	job->state = JOB_WAITING;
}

bool jobs_compiling(const struct jobs *jobs, uint64_t code)
{
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++)
		if (jobs->compilers[i].code == code)
			return true;
	return false;
}

bool jobs_compiled_since(const struct jobs *jobs, uint64_t since_us)
{
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++)
		if (jobs->compilers[i].code)
			return true;
	return jobs->compiled_us >= since_us;
}

// A free compiler that the peer may have. NULL: there is none.
static struct compiler *find_free(struct jobs *jobs, uint64_t peer)
{
	struct compiler *compiler = NULL;
	unsigned has = 0, left = 0;
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++) {
		struct compiler *c = &jobs->compilers[i];
		if (!c->code) {
			compiler = c;
			left++;
		} else if (c->peer == peer) {
			has++;
		}
	}
	return share_allows(has, 1, left) ? compiler : NULL;
}

bool jobs_compile(struct jobs *jobs, uint64_t peer, uint64_t code, const struct subject *subject,
		  const candil_Render *render, uint32_t pilot_us)
{
	struct error err;
	if (jobs_compiling(jobs, code))
		return true;
	struct compiler *compiler = find_free(jobs, peer);
	if (!compiler)
		return false;
	compiler->peer = peer;
	if (compiler_start(compiler, code, subject, render, pilot_us, &err) != STATUS_OK) {
		log_line(LOG_ERROR, "no compiler: %s", err.text);
		jobs_compiled(jobs, code, NULL);
	}
	return true;
}

void jobs_compile_next(struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count; i++) {
		const struct job *job = jobs->job[i];
		if (job->compiling)
			jobs_compile(jobs, job->session->peer->id, job->code, &job->subject, &job->render, 0);
	}
}

void jobs_compiled(void *owner, uint64_t code, const char *failure)
{
	struct jobs *jobs = owner;
	struct error err;
	jobs->compiled_us = clock_us();
	jobs_let_others_try(jobs); // it had memory of the device, too
	if (failure)
		error_set(&err, STATUS_WORKER_LOST,
			  "the driver's compiler was lost over this job's shader code (%s): leave out effects, or update "
			  "the driver",
			  failure);
	// Backwards, and with an eye on the count: a job that fails takes the other jobs of its sweep along.
	for (unsigned i = jobs->count; i-- > 0;) {
		struct job *job = i < jobs->count ? jobs->job[i] : NULL;
		if (!job || job->code != code || !job->compiling)
			continue;
		job->compiling = false;
		if (failure)
			jobs_fail(jobs, job, &err);
	}
}
