#include "server/worker/plan/needs.h"

#include <string.h>

#include "protocol/names.h"
#include "server/worker/technique/common/scene_params.h"
#include "server/worker/technique/technique.h"

// Bytes of a note for the names of options and what they need: those that do not fit are told in another.
#define NOTE_ROOM (sizeof((candil_Accepted *)0)->notes[0] - sizeof " and  do nothing without ")

// The first need of an option that is not met, as a sentence's end. NULL: there is none.
static const char *unmet(const char *option, const struct option_need *needs, const struct plan *plan)
{
	for (; needs->option; needs++)
		if (!strcmp(needs->option, option) && !needs->met(plan))
			return needs->what;
	return NULL;
}

void needs_note(const candil_Render *request, const struct technique *technique, const struct plan *plan,
		candil_Accepted *accepted)
{
	const char *whats[LIMIT_OPTIONS], *names[LIMIT_OPTIONS];
	if (!technique->needs)
		return;
	for (pb_size_t i = 0; i < request->options_count; i++)
		whats[i] = unmet(request->options[i].name, technique->needs, plan);
	for (pb_size_t i = 0; i < request->options_count; i++) {
		const char *what = whats[i];
		char list[LIMIT_TEXT + 1];
		size_t count = 0, length = 0;
		for (pb_size_t k = i; what && k < request->options_count; k++)
			if (whats[k] && !strcmp(whats[k], what) &&
			    (length += strlen(request->options[k].name) + strlen(", ")) + strlen(what) < NOTE_ROOM) {
				names[count++] = request->options[k].name;
				whats[k] = NULL;
			}
		names_list(names, count, "and", list, sizeof list);
		if (count > 0)
			technique_note(accepted, "%s %s nothing without %s", list, count > 1 ? "do" : "does", what);
	}
}
