#include "server/front/jobs/warnings.h"

#include <stdio.h>
#include <string.h>

#include "server/front/jobs/table.h"
#include "server/front/scenes.h"

#define LEFT_OUT "the file asks for what is left out: "

static void add(candil_Accepted *accepted, const char *text)
{
	for (pb_size_t i = 0; i < accepted->warnings_count; i++)
		if (strcmp(accepted->warnings[i], text) == 0)
			return;
	if (accepted->warnings_count == LIMIT_WARNINGS)
		accepted->warnings_more++;
	else
		snprintf(accepted->warnings[accepted->warnings_count++], sizeof accepted->warnings[0], "%s", text);
}

// Features that are left out, as many in a sentence as fit.
static void add_ignored(const struct scene *scene, candil_Accepted *accepted)
{
	char text[sizeof accepted->warnings[0]] = LEFT_OUT;
	const size_t begin = sizeof LEFT_OUT - 1;
	size_t used = begin;
	for (pb_size_t i = 0; i < scene->info.ignored_count; i++) {
		const char *feature = scene->info.ignored[i];
		if (scene->remarks.ignored >> i & 1u)
			continue;
		if (used + 2 + strlen(feature) >= sizeof text) {
			add(accepted, text);
			used = begin;
		}
		used += (size_t)snprintf(text + used, sizeof text - used, "%s%s", used > begin ? ", " : "", feature);
	}
	if (used > begin)
		add(accepted, text);
}

static void add_scene(const struct scene *scene, candil_Accepted *accepted)
{
	for (pb_size_t i = 0; i < scene->info.warnings_count; i++)
		if (!(scene->remarks.warnings >> i & 1u))
			add(accepted, scene->info.warnings[i]);
	accepted->warnings_more += scene->info.warnings_more;
	add_ignored(scene, accepted);
}

void warnings_fill(const struct job *job, candil_Accepted *accepted)
{
	accepted->warnings_count = 0;
	accepted->warnings_more = 0;
	for (unsigned i = 0; i < PARTS; i++)
		if (job->subject.part[i])
			add_scene(job->subject.part[i], accepted);
}
