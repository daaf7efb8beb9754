// A scene's sections in OpenGL's storage buffers: made from the blob at their first use and kept with the resident scene.
// Device's thread only.
#ifndef CANDIL_WORKER_GL_SCENE_H
#define CANDIL_WORKER_GL_SCENE_H

#include "server/worker/gl/buffer.h"
#include "server/worker/scenes/resident.h"

// The buffers of one resident scene, which owns this.
struct gl_scene {
	struct derived derived; // destroyed when the resident scene leaves the device
	struct gl_device *device;
	const struct gl_scene
	    *base; // of an edited scene: has the buffers that it shares with its base; set anew by each gl_scene_get
	struct gl_buffer buffers[BIND_SCENE_COUNT]; // by binding; zeroed: not on the device
	// Texel buffers over BIND_NODES, BIND_LEAF_TRIANGLES, BIND_TRIANGLES and BIND_VERTICES, four words a texel.
	unsigned node_texels, leaf_texels, triangle_texels, vertex_texels;
};

// The scene's buffers, after those of `bindings` (bits 1 << BIND_…) that were missing have been uploaded. *out stays the
// resident scene's. Sections without elements stay off. STATUS_MEMORY if a buffer does not fit, STATUS_DEVICE; what has been
// uploaded by then stays.
enum status gl_scene_get(struct resident_scene *scene, struct gl_device *device, uint32_t bindings, struct gl_scene **out,
			 struct error *err);

// The buffer of a binding, the scene's own or its base's; zeroed if it is not on the device. It stays the scene's.
const struct gl_buffer *gl_scene_buffer(const struct gl_scene *scene, uint32_t binding);

// Bind every buffer that is there to the storage block of its number. The BVH is bound as texel buffers instead, to texture
// units UNIT_NODES and UNIT_LEAF_TRIANGLES, as far as it is among `bindings`: what others have uploaded must not make it
// seem that a program is to run with other textures (gl_shape).
void gl_scene_bind(const struct gl_scene *scene, uint32_t bindings);

// Bind triangles and vertices as texel buffers, too, to texture units UNIT_TRIANGLES and UNIT_VERTICES.
void gl_scene_bind_corners(const struct gl_scene *scene);

#endif
