// What of a request decides its cost and its error, hashed. For the front's one thread. Nothing fails.
#ifndef CANDIL_FRONT_QUOTES_KEY_H
#define CANDIL_FRONT_QUOTES_KEY_H

#include "candil.pb.h"
#include "server/front/quotes/model.h"
#include "server/front/subject.h"

// The key of a checked request for `technique`, whatever its own, with no word on what a worker alone knows. `of` are the
// hashes of what it is about, `device` is the worker's word.
struct quote_key quote_key_of(const candil_Render *render, candil_Technique technique, const struct subject_hashes *of,
			      const char *device);

// What programs, or what is made of a scene, depend on: requests of the same are warm once one of them was rendered. `of` is
// for programs what quote_facts_of says, for what is made of a scene quote_made_of; `key` is the request's.
uint64_t quote_warmth_of(const struct quote_key *key, uint64_t of);

// What of a subject its programs depend on: the facts of its scene that the plan reads, and which other parts there are.
uint64_t quote_facts_of(const struct subject *subject);

// What is made of a scene depends on all that goes with it: a hash of the front's numbers.
uint64_t quote_made_of(const struct subject *subject);

#endif
