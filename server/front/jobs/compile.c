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

static struct compiler *free_compiler(struct jobs *jobs)
{
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++)
		if (!jobs->compilers[i].code)
			return &jobs->compilers[i];
	return NULL;
}

static bool is_compiled(const struct jobs *jobs, uint64_t code)
{
	for (unsigned i = 0; i < LIMIT_COMPILERS; i++)
		if (jobs->compilers[i].code == code)
			return true;
	return false;
}

void jobs_compile_next(struct jobs *jobs)
{
	struct compiler *compiler;
	for (unsigned i = 0; i < jobs->count && (compiler = free_compiler(jobs)); i++) {
		struct job *job = jobs->job[i];
		struct error err;
		if (!job->compiling || is_compiled(jobs, job->code))
			continue;
		if (compiler_start(compiler, job->code, job->scene, job->environment, &job->render, &err) == STATUS_OK)
			continue;
		log_line(LOG_ERROR, "no compiler: %s", err.text);
		jobs_compiled(jobs, job->code);
	}
}

void jobs_compiled(void *owner, uint64_t code)
{
	struct jobs *jobs = owner;
	for (unsigned i = 0; i < jobs->count; i++)
		if (jobs->job[i]->code == code)
			jobs->job[i]->compiling = false;
}
