// The scene, for passes of hemicubes that look at masks: without what they do not need, for OpenGL has few storage blocks.
#ifndef RADIOSITY_HEMICUBE_SCENE_GLSL
#define RADIOSITY_HEMICUBE_SCENE_GLSL

#define SCENE_WITHOUT_TRACE
#define SCENE_WITHOUT_LAMPS
#define SCENE_WITHOUT_TANGENTS
#define SCENE_WITHOUT_GGX
#include "common/scene.glsl"

#endif
