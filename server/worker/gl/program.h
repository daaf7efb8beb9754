// Programs on the OpenGL device, made at their first use and kept by it: GLSL with its effects and options as macros before
// it. The mirror of vk/pipeline.h, where effects and options are specialization constants. Device's thread only.
#ifndef CANDIL_WORKER_GL_PROGRAM_H
#define CANDIL_WORKER_GL_PROGRAM_H

#include "server/worker/gl/device.h"

#define GL_DEFINES_BYTES 1024u // of all macros of a program, the end included

// GLSL 4.5 without its #version line and with all includes in it, as make_source writes it. It has either `compute` alone,
// or `vertex` and `fragment`, the latter NULL where only depth is drawn. A static constant of whoever runs it: its address
// and the macros are the key of a program.
struct gl_source {
	const char *name; // a literal, for messages and as a stage's name
	const char *compute;
	const char *vertex;
	const char *fragment;
};

#define GL_PROGRAM_SHAPES 16u // that are remembered of a program

// A linked program, for reading.
struct gl_program {
	struct gl_program *next;
	const struct gl_source *source;
	uint64_t piece; // of the list of code; a run with textures of other shapes is a piece that follows from it
	char defines[GL_DEFINES_BYTES];
	unsigned name; // OpenGL's
	uint32_t users; // holds of it: gl_program_hold
	uint64_t used; // device->program_turn when it was last asked for
	uint64_t warm[GL_PROGRAM_SHAPES]; // shapes of textures that it has run with, so that the driver has compiled it
	uint32_t warm_count; // that it has run with; the latest are kept
};

// The macros of a program: lines that come before its source. Zeroed: none.
struct gl_defines {
	char text[GL_DEFINES_BYTES];
	bool full; // something did not fit: gl_program_get refuses it
};

// Add "#define NAME VALUE", the value printf-formatted. What does not fit sets `full`.
void gl_define(struct gl_defines *defines, const char *name, const char *format, ...) __attribute__((format(printf, 3, 4)));

// Add the macros EFFECT_… of effects.glsl for a plan's effects, bits 1 << candil_Effect.
void gl_define_effects(struct gl_defines *defines, uint32_t effects);

// The most programs that are kept, because requests can ask for very many. Beyond it the one unused for longest is
// destroyed, but never one that is held.
#define GL_PROGRAMS_MAX 192u

// The program of a source with these macros, compiled and linked if it is not kept, which may take seconds. It is the
// device's: the next call may destroy it unless it is held. STATUS_INTERNAL with the compiler's first words, for macros that
// are `full`, or where device->code refuses to compile it now; STATUS_MEMORY, STATUS_DEVICE.
enum status gl_program_get(struct gl_device *device, const struct gl_source *source, const struct gl_defines *defines,
			   struct gl_program **program, struct error *err);

// Put a program into use, with no texture bound for it yet. What it reads and writes is bound behind this call.
void gl_program_use(struct gl_device *device, const struct gl_program *program);

// Take down that a texture, an image or a texel buffer of some shape is bound; `shape` is any number that differs if the
// driver may have to compile another program.
void gl_shape(struct gl_device *device, uint64_t shape);

// Whether the program in use has run with textures of the shapes that are bound, and so is compiled. On hardware any run is
// enough.
bool gl_program_is_warm(const struct gl_device *device, const struct gl_program *program);

// The same, for a caller who will run it. STATUS_INTERNAL: it is not, and device->code refuses to compile it now.
enum status gl_program_ask(const struct gl_device *device, const struct gl_program *program, bool *warm, struct error *err);

// It has run.
void gl_program_has_run(const struct gl_device *device, struct gl_program *program);

// Hold a program for as long as the caller keeps a pointer to it, and let go of it: once for each hold. NULL is allowed in
// both.
void gl_program_hold(struct gl_program *program);
void gl_program_release(struct gl_program *program);

// Destroy all programs, held or not. To be called before gl_device_destroy.
void gl_program_destroy_all(struct gl_device *device);

#endif
