// Jobs that the worker has refused because shader code has to be compiled first. A process of its own does that
// (front/compiler.h), and the job waits for it as if its scene were still loading; several that need the same code wait
// together. A job that is refused again for the same code has it compiled by the worker, whoever waits: where no cache is
// kept there is no other way.
//
// For the files of this folder alone.
#ifndef CANDIL_FRONT_JOBS_COMPILE_H
#define CANDIL_FRONT_JOBS_COMPILE_H

#include "server/front/jobs/table.h"

// The worker refuses a job for want of this code: it waits, or will have it compiled by the worker.
void job_compile_first(struct job *job, uint64_t code);

// Start compilers for jobs that wait for one, as far as there are any free.
void jobs_compile_next(struct jobs *jobs);

// Has any compiler run since then?
bool jobs_compiled_since(const struct jobs *jobs, uint64_t since_us);

// A compiler of this code has ended: the jobs that waited for it go on, or fail with it (compiler.h).
void jobs_compiled(void *jobs, uint64_t code, const char *failure);

#endif
