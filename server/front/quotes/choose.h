// Which of many ways to render is the best for a time or an error. Values alone, for the front's one thread; nothing fails.
#ifndef CANDIL_FRONT_QUOTES_CHOOSE_H
#define CANDIL_FRONT_QUOTES_CHOOSE_H

#include "candil.pb.h"
#include "server/front/quotes/model.h"

#define QUOTE_OPEN_SAMPLES 65536u // what request.c fills in where an end is given and no number of samples

// A way to render, and what to expect of it.
struct quote_way {
	candil_Technique technique;
	uint32_t samples;
	struct quote_prediction said;
	double sure_us; // nine times of ten what cannot be cut short is there by then: of noise the first sample, else all
};

// What is asked, and who knows.
struct quote_ask {
	const candil_Render *render; // a checked one: its technique (AUTO: any), samples, options, end, size
	bool samples_given; // by the client, so that no technique is to take more
	bool count_cold; // what is cold counts against the deadline
	uint32_t refused; // bits 1 << candil_Technique: could not render the scene when it was looked at
	void *user;
	// What others add to so much work, which counts against the deadline. NULL: nothing.
	double (*queue_us)(void *user, double us);
	// Predict the request by a technique and samples. `way->said` is filled in.
	void (*predict)(void *user, struct quote_way *way);
};

// Answer; some technique can. choice, met, why, cheaper and better of `reply` are set, the rest is the caller's.
void quote_choose(const struct quote_ask *ask, candil_QuoteReply *reply);

// Whether a technique can render the request, as far as its traits and the names of its options tell.
bool quote_can(const candil_Render *render, candil_Technique technique);

#endif
