// Programs on the OpenGL device, made on first use and kept: GLSL with its effects and options as macros before it. The
// mirror of vk/pipeline.h, where they are specialization constants.
#ifndef CANDIL_WORKER_GL_PROGRAM_H
#define CANDIL_WORKER_GL_PROGRAM_H

#include "server/worker/gl/device.h"

#define GL_DEFINES_BYTES 1024u

// GLSL 4.5 without its #version line and with all includes in it, as make_source writes it. Either `compute` alone or
// `vertex` and, unless depth is all that is drawn, `fragment`.
struct gl_source {
	const char *name; // unique: the key with the macros
	const char *compute;
	const char *vertex;
	const char *fragment;
};

struct gl_program {
	struct gl_program *next;
	const struct gl_source *source;
	char defines[GL_DEFINES_BYTES];
	unsigned name;
	uint32_t users; // who keep a pointer to it: gl_program_hold
	uint64_t used; // when it was last asked for, in turns of the device
	bool warm; // its user has run it once, so that the driver has compiled it
};

// The lines that come before a source.
struct gl_defines {
	char text[GL_DEFINES_BYTES];
	bool full; // something did not fit: gl_program_get refuses it
};

void gl_define(struct gl_defines *defines, const char *name, const char *format, ...) __attribute__((format(printf, 3, 4)));

// The EFFECT_… of effects.glsl by the plan's bits, 1 << effect.
void gl_define_effects(struct gl_defines *defines, uint32_t effects);

// Programs of different macros that are kept; beyond that the one unused for longest goes, for requests can ask for very
// many.
#define GL_PROGRAMS_MAX 192u

// The program, compiled and linked at its first use. Owned by the device: it may be gone after the next call unless it is
// held. STATUS_INTERNAL with the compiler's first words.
enum status gl_program_get(struct gl_device *device, const struct gl_source *source, const struct gl_defines *defines,
			   struct gl_program **program, struct error *err);

// Keep it for as long as the caller has a pointer to it. NULL is allowed in both.
void gl_program_hold(struct gl_program *program);
void gl_program_release(struct gl_program *program);

// All that the device keeps, with its context current: before the device itself.
void gl_program_destroy_all(struct gl_device *device);

#endif
