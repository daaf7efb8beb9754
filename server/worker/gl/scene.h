// A scene's sections in OpenGL's storage buffers: made of the blob at first use and kept with the resident scene.
#ifndef CANDIL_WORKER_GL_SCENE_H
#define CANDIL_WORKER_GL_SCENE_H

#include "server/worker/gl/buffer.h"
#include "server/worker/scenes/resident.h"

struct gl_scene {
	struct derived derived; // it goes when the resident scene leaves the device
	struct gl_device *device;
	const struct gl_scene
	    *base; // of an edited scene: whose buffers are bound that it shares; set anew by each gl_scene_get
	struct gl_buffer buffers[BIND_SCENE_COUNT]; // by binding; zeroed: not on the device
	unsigned node_texels, leaf_texels; // views of two of them as texels of four words
};

// The scene's buffers, those of `bindings` (bits 1 << BIND_…) uploaded. Owned by the resident scene.
enum status gl_scene_get(struct resident_scene *scene, struct gl_device *device, uint32_t bindings, struct gl_scene **out,
			 struct error *err);

// Bind all that is there, each to the storage block of its number, what rays walk through to texture units UNIT_NODES and
// UNIT_LEAF_TRIANGLES instead.
void gl_scene_bind(const struct gl_scene *scene);

#endif
