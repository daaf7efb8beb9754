// What a software driver makes of state that no pass sets. Device's thread only.
//
// Such a driver compiles a program for the state of its samplers. Mesa 22 leaves the sampler of a texel buffer as whatever
// program ran before has left it in that place (st_atom_sampler.c: "don't update the sampler for TBOs"). So a program that
// reads the scene's tree would be compiled anew, for most of a second, in the middle of a picture, because another pass ran
// since. After gl_settle all samplers are in the same state.
//
// It also keeps what was deleted for as long as the last program had it bound. After gl_settle and a wait it is free.
#ifndef CANDIL_WORKER_GL_SETTLE_H
#define CANDIL_WORKER_GL_SETTLE_H

#include "server/worker/gl/device.h"

// Make what gl_settle needs, unless it is there. Nothing on a device of hardware. Fails as gl_program_get does.
enum status gl_settle_prepare(struct gl_device *device, struct error *err);

// Put all samplers into one state, by a program that does nothing else; another is to be put into use afterwards. Nothing
// before gl_settle_prepare.
void gl_settle(struct gl_device *device);

// Free it.
void gl_settle_finish(struct gl_device *device);

#endif
