// What the reply to a render says about its scene. For the front's one thread.
#ifndef CANDIL_FRONT_JOBS_WARNINGS_H
#define CANDIL_FRONT_JOBS_WARNINGS_H

#include "candil.pb.h"

struct job;

// Fill in `warnings` and `warnings_more`: whatever was mended or left out of the job's scene, and of the picture around it,
// and shows in pictures. Each sentence once; features that are left out share sentences.
void warnings_fill(const struct job *job, candil_Accepted *accepted);

#endif
