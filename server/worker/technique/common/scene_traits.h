// What a scene has that shaders must be made for, beside effects: macros of an OpenGL program and specialization constants
// of a Vulkan pipeline, under the same names. A scene without them gets the same shaders as if they did not exist. Any
// thread; nothing here fails, but what is full by then refuses the program (gl_program_get, pipeline_get).
#ifndef CANDIL_WORKER_TECHNIQUE_SCENE_TRAITS_H
#define CANDIL_WORKER_TECHNIQUE_SCENE_TRAITS_H

#include "server/worker/gl/program.h"
#include "server/worker/scenes/resident.h"
#include "server/worker/vk/pipeline.h"

// Add the macros of a program that shades this scene by these effects (bits 1 << candil_Effect): gl_define_effects, and
// those of the scene.
void scene_define(struct gl_defines *defines, const struct resident_scene *scene, uint32_t effects);

// The same as constants: constants_set_effects, and SPEC_SCENE to SPEC_SCENE_END.
void scene_set_constants(struct constants *constants, const struct resident_scene *scene, uint32_t effects);

#endif
