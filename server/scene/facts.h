// A scene's facts: properties by which the plan decides which effects a render needs. What cannot change a picture is no
// fact: a mask whose alpha is 1 everywhere, a coat that its texture takes away, a texture on black. The loader finds them
// once, and the blob's header carries them. Any thread; cannot fail.
#ifndef CANDIL_SCENE_FACTS_H
#define CANDIL_SCENE_FACTS_H

#include <stdint.h>

#include "server/scene/blob.h"

// The facts of a blob whose sections are complete. header.facts is not read.
uint32_t facts_collect(const struct blob_header *blob);

// The facts of a view. Its own `facts` are not read. Looks at every triangle, and at some texels of every material.
uint32_t facts_of_view(const struct blob_view *view);

// The facts of a view where what the facts `hidden` stand for is not simulated, and what `forced` stand for is, whatever the
// scene says. Without metals, say, roughness of diffuse surfaces counts on those too. None of `hidden` is returned. What no
// effect changes is taken from view->facts. Looks at materials, not at triangles or texels.
uint32_t facts_given(const struct blob_view *view, uint32_t hidden, uint32_t forced);

// What materials that are used have by name, whether it changes a picture or not: FACT_TEXTURES, _EMITTERS, _GLOSSY,
// _NORMAL_MAPS, _ALPHA_MASK, _VERTEX_COLORS, _UNLIT, _GLASS, _ALPHA_BLEND, _CLEARCOAT and _ROUGH_DIFFUSE.
uint32_t facts_by_name(const struct blob_view *view);

// The name of a fact as `describe` prints it, such as "textures" or "spot lights". Static storage. NULL unless exactly one
// known bit is set.
const char *fact_name(enum fact fact);

#endif
