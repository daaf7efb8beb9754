// Options that are given and do nothing, because of what others say. Scripts that try one option after the other give them
// as a matter of course, so they are told in notes, and refused only where two contradict each other (struct technique's
// `check`). Host only, any thread.
//
// Example
//	static bool gathers(const struct plan *plan)
//	{
//		return radiosity_settings(plan)->display == RADIOSITY_DISPLAY_GATHER;
//	}
//	const struct option_need needs[] = {{"radiosity.gather", "radiosity.display=gather", gathers}, {0}};
#ifndef CANDIL_WORKER_PLAN_NEEDS_H
#define CANDIL_WORKER_PLAN_NEEDS_H

#include <stdbool.h>

#include "candil.pb.h"

struct plan; // plan.h
struct technique; // worker/technique/technique.h

// What an option needs to do anything. A technique has an array of them, ended by one without an option.
struct option_need {
	const char *option;
	const char *what; // the end of the sentence "… does nothing without …"
	bool (*met)(const struct plan *plan);
};

// Add a note to accepted->notes for each need that options of the request have and that is not met, as long as there is
// room. Of an option the first such need counts.
void needs_note(const candil_Render *request, const struct technique *technique, const struct plan *plan,
		candil_Accepted *accepted);

#endif
