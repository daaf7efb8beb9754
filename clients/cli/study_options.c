// The command line of `candil study`: render's options, which count for all runs and are repeated in the commands that make
// them again, and its own.
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "clients/cli/render_values.h"
#include "clients/cli/study.h"
#include "clients/cli/words.h"
#include "clients/libcandil/error.h"

#define FULL_SIDE 256u
#define FULL_SEEDS 8u
#define FULL_REPEATS 3u
#define FULL_BUDGET_S 600.0
#define QUICK_SIDE 128u
#define QUICK_SEEDS 4u
#define QUICK_REPEATS 2u
#define QUICK_BUDGET_S 45.0

// Take an option that is the study's own, and note down all others.
static bool take(void *user, const char *name, const char *value)
{
	static const char *const silent[] = {"output", "size", "quiet", NULL};
	struct study_texts *t = user;
	const struct {
		const char *name, **text;
	} texts[] = {{"techniques", &t->techniques}, {"budget", &t->budget}, {"plan", &t->plan}, {"seeds", &t->seeds}};
	for (size_t i = 0; i < sizeof(texts) / sizeof(*texts); i++)
		if (strcmp(name, texts[i].name) == 0) {
			*texts[i].text = value;
			return true;
		}
	if (strcmp(name, "quick") == 0)
		return t->quick = true;
	if (strcmp(name, "camera") == 0) {
		t->too_many |= t->camera_count == STUDY_VIEWS_MAX;
		if (!t->too_many)
			t->cameras[t->camera_count++] = value;
		return true;
	}
	t->sized |= strcmp(name, "size") == 0;
	if (strcmp(name, "effects") == 0)
		t->shared_full |= (size_t)snprintf(t->effects, sizeof(t->effects), "%s", value) >= sizeof(t->effects);
	for (size_t i = 0; silent[i]; i++)
		if (strcmp(name, silent[i]) == 0)
			return false;
	char option[64];
	snprintf(option, sizeof(option), "--%s", name);
	study_quote(t->shared, sizeof(t->shared), option, &t->shared_full);
	if (value)
		study_quote(t->shared, sizeof(t->shared), value, &t->shared_full);
	return false;
}

// Find the techniques of a list with commas. false: a word is none that renders.
static bool find_techniques(const char *list, unsigned *out)
{
	*out = 0;
	for (unsigned t = 1; !list && t < TECHNIQUE_COUNT; t++)
		if (technique_traits(t) & TECHNIQUE_RENDERS)
			*out |= 1u << t;
	while (list && *list) {
		const size_t length = strcspn(list, ",");
		const int number = technique_number(list, length);
		if (number <= 0 || !(technique_traits((unsigned)number) & TECHNIQUE_RENDERS))
			return false;
		*out |= 1u << number;
		list += length + (list[length] == ',');
	}
	return *out != 0;
}

static void copy_text(char *out, size_t capacity, const char *text)
{
	snprintf(out, capacity, "%s", text);
}

// The plan's values that the command line alone says. Returns the sentence that says what is wrong, or NULL.
static const char *settle_plan(struct study *study)
{
	struct study_texts *t = &study->texts;
	struct study_plan *p = &study->plan;
	struct candil_render_request request;
	if (t->too_many)
		return "--camera is taken 32 times at most";
	if (t->shared_full)
		return "these options are too long for the commands of a report";
	if (t->quick && t->plan)
		return "--quick and --plan exclude each other: a plan file says itself what is done";
	if (t->seeds && (!cli_parse_u32(t->seeds, &p->seeds) || p->seeds < 1 || p->seeds > STUDY_SEEDS_MAX))
		return "--seeds is a whole number from 1 to 1000";
	if (t->budget && (!cli_parse_double(t->budget, &p->budget_s) || p->budget_s < 1 || p->budget_s > STUDY_BUDGET_MAX))
		return "--budget is a number of seconds from 1 to 604800";
	for (uint32_t i = 0; i < t->camera_count; i++) {
		struct study_view *v = &p->views[i];
		if (strlen(t->cameras[i]) >= sizeof(v->camera) || !value_camera(t->cameras[i], &request))
			return "--camera is the name of a camera, or ten numbers: ex,ey,ez,tx,ty,tz,ux,uy,uz,VFOV";
		copy_text(v->camera, sizeof(v->camera), t->cameras[i]);
		if (request.has_camera)
			snprintf(v->name, sizeof(v->name), "camera %u", i + 1);
		else
			copy_text(v->name, sizeof(v->name), t->cameras[i]);
	}
	return NULL;
}

bool study_options(struct study *study, struct cli *cli, const struct command *self, int argc, char **argv,
		   enum exit_code *code)
{
	struct study_plan *p = &study->plan;
	struct study_texts *t = &study->texts;
	struct candil_error error;
	const struct option_watch watch = {take, t};
	bool full = false;
	copy_text(study->command, sizeof(study->command), "candil study");
	for (int i = 1; i < argc; i++)
		study_quote(study->command, sizeof(study->command), argv[i], &full);
	if (!study_options_parse(cli, self, argc, argv, &study->job.options, &watch, code))
		return false;
	*code = EXIT_USAGE;
	if (full) {
		cli_usage(self, "the command is longer than the 4095 bytes that a report tells: shorten its paths");
		return false;
	}
	*p = (struct study_plan){
	    .view_count = t->camera_count > 0 ? t->camera_count : 1,
	    .seeds = t->quick ? QUICK_SEEDS : FULL_SEEDS,
	    .repeats = t->quick ? QUICK_REPEATS : FULL_REPEATS,
	    .budget_s = t->quick ? QUICK_BUDGET_S : FULL_BUDGET_S,
	    .ablations = !t->quick && !t->plan,
	    .reference = true,
	    .reference_seed = STUDY_REFERENCE_SEED,
	    .width = t->quick ? QUICK_SIDE : FULL_SIDE,
	    .height = t->quick ? QUICK_SIDE : FULL_SIDE,
	    .views = {{.name = "view"}},
	};
	char *list = words_text("--techniques is a list of {techniques}, with commas between");
	const bool known = find_techniques(t->techniques, &study->techniques);
	if (!known)
		cli_usage(self, "%s", list ? list : "--techniques names one that does not render");
	free(list);
	if (!known)
		return false;
	const char *wrong = strcmp(study->job.options.output, "-") == 0 ? "-o names a folder" : settle_plan(study);
	if (wrong) {
		cli_usage(self, "%s", wrong);
		return false;
	}
	if (t->plan && study_plan_read(t->plan, study->techniques, p, &error) != CANDIL_STATUS_OK) {
		*code = cli_fail(cli, &error, stdout);
		return false;
	}
	// The command line is closer than the file.
	if (t->plan && settle_plan(study))
		return false;
	if (t->camera_count > 0)
		p->view_count = t->camera_count;
	if (t->sized) {
		p->width = study->job.options.request.width;
		p->height = study->job.options.request.height;
	}
	if ((uint64_t)p->width * p->height > LIMIT_STUDY_PIXELS) {
		error_set(&error, CANDIL_STATUS_LIMIT,
			  "%" PRIu32 "x%" PRIu32 " pixels are too many for a report, which has at most %u: 3840x2160 fits",
			  p->width, p->height, LIMIT_STUDY_PIXELS);
		*code = cli_fail(cli, &error, stdout);
		return false;
	}
	p->planned_s = 0;
	p->left_out = 0;
	if (!t->plan && !study_default_points(study)) {
		cli_usage(self, "there is no memory for the points");
		return false;
	}
	return true;
}
