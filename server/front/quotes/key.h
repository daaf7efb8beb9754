// What of a request decides its cost and its error, hashed. For the front's one thread. Nothing fails.
#ifndef CANDIL_FRONT_QUOTES_KEY_H
#define CANDIL_FRONT_QUOTES_KEY_H

#include "candil.pb.h"
#include "server/front/quotes/model.h"

// The key of a checked request for `technique`, whatever its own. `scene` and `environment` (NULL: none) are hashes as
// SceneInfo has them, `device` is the worker's word.
struct quote_key quote_key_of(const candil_Render *render, candil_Technique technique, const char *scene,
			      const char *environment, const char *device);

// What programs, or what is made of a scene, depend on: requests of the same are warm once one of them was rendered. `of` is
// for programs what quote_facts_of says, for what is made of a scene the front's number of it; `key` is the request's.
uint64_t quote_warmth_of(const candil_Render *render, const struct quote_key *key, uint64_t of);

// What of a scene its programs depend on: the facts that the plan reads, and whether there is a picture of its surroundings.
uint64_t quote_facts_of(const candil_SceneInfo *scene, bool environment);

#endif
