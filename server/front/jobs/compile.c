#include "server/front/jobs/compile.h"

#include "server/base/log.h"

void job_compile_first(struct jobs *jobs, struct job *job, uint64_t code)
{
	(void)jobs;
	job->compile = job->code == code;
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

bool jobs_compile(struct jobs *jobs, uint64_t code, const struct scene *scene, const struct scene *environment,
		  const candil_Render *render, uint32_t pilot_us)
{
	struct compiler *compiler = NULL;
	struct error err;
	if (jobs_compiling(jobs, code))
		return true;
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++)
		if (!jobs->compilers[i].code)
			compiler = &jobs->compilers[i];
	if (!compiler)
		return false;
	if (compiler_start(compiler, code, scene, environment, render, pilot_us, &err) != STATUS_OK) {
		log_line(LOG_ERROR, "no compiler: %s", err.text);
		jobs_compiled(jobs, code);
	}
	return true;
}

void jobs_compile_next(struct jobs *jobs)
{
	for (unsigned i = 0; i < jobs->count; i++) {
		const struct job *job = jobs->job[i];
		if (job->compiling && !jobs_compile(jobs, job->code, job->scene, job->environment, &job->render, 0))
			return;
	}
}

void jobs_compiled(void *owner, uint64_t code)
{
	struct jobs *jobs = owner;
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->code == code)
			jobs->job[i]->compiling = false;
}
