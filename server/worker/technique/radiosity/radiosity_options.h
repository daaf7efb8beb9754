// The options of radiosity. README says what each does. Host only, any thread.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_OPTIONS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_OPTIONS_H

#include "server/worker/technique/direct/direct_options.h"
#include "server/worker/technique/radiosity/row_maker.h"

// Whether light goes on by mirrors.
enum radiosity_mirrors {
	RADIOSITY_MIRRORS_AUTO,
	RADIOSITY_MIRRORS_ON,
	RADIOSITY_MIRRORS_OFF,
	RADIOSITY_MIRRORS_PORTAL // as auto, but hemicubes look into mirrors in place of rays that go on from their pixels
};

// How light of emissive surfaces is found: by points on them, or by form factors alone. auto: by points where they are small
// beside the scene.
enum radiosity_emitters { RADIOSITY_EMITTERS_AUTO, RADIOSITY_EMITTERS_POINTS, RADIOSITY_EMITTERS_FACTORS };

// How light is shown: between the corners of patches, by patch, or by a gather.
enum radiosity_display { RADIOSITY_DISPLAY_VERTEX, RADIOSITY_DISPLAY_CONSTANT, RADIOSITY_DISPLAY_GATHER };

// What form factors are projected onto (factors_project.h): nothing; rows that sum up to 1; those, and pairs that agree.
enum radiosity_project { RADIOSITY_PROJECT_NONE, RADIOSITY_PROJECT_SUMS, RADIOSITY_PROJECT_BOTH };

// What is shown in place of light.
enum radiosity_show {
	RADIOSITY_SHOW_NONE,
	RADIOSITY_SHOW_B,
	RADIOSITY_SHOW_E,
	RADIOSITY_SHOW_ALBEDO,
	RADIOSITY_SHOW_ID,
	RADIOSITY_SHOW_NORMAL,
	RADIOSITY_SHOW_RESIDUAL,
	RADIOSITY_SHOW_ROW
};

// The values of the options.
struct radiosity_settings {
	struct direct_settings direct; // first: direct_settings() reads them
	float edge; // metres: a patch's sides are no longer; 0: `patches` decides
	uint32_t patches; // as many or somewhat less, but at least one a face
	uint32_t factors; // enum row_way
	uint32_t rays; // of a row of form factors
	uint32_t pixels; // of a hemicube's face
	uint32_t origins; // hemicubes of a patch
	uint32_t mirrors; // enum radiosity_mirrors
	uint32_t bounces; // of a ray by mirrors, at most
	uint32_t points; // of a patch, from which lights are looked at
	uint32_t emitters; // enum radiosity_emitters
	uint32_t project; // enum radiosity_project
	uint32_t solver; // enum solver_way
	float residual; // the solver ends there
	uint32_t display; // enum radiosity_display
	uint32_t gather; // rays of a sample of a pixel, where display is by gather
	uint32_t show; // enum radiosity_show
	uint32_t row; // the element whose row is shown; NONE: the one in the picture's middle
};

// struct technique's `options`, `needs`, `defaults` and `check`.
extern const struct option_table radiosity_options[];
extern const struct option_need radiosity_needs[];
void radiosity_options_default(void *settings);
enum status radiosity_options_check(const struct plan *plan, struct error *err);

// Whether these settings let light go on by mirrors, where a scene has some; `on`, as if it had.
static inline bool radiosity_has_mirrors(const struct radiosity_settings *s)
{
	return s->mirrors != RADIOSITY_MIRRORS_OFF && s->factors != ROWS_BY_CONTOUR;
}

// The settings in a plan of this technique.
static inline const struct radiosity_settings *radiosity_settings(const struct plan *plan)
{
	return (const struct radiosity_settings *)&plan->settings;
}

// The same, to be changed.
static inline struct radiosity_settings *radiosity_settings_of(struct plan *plan)
{
	return (struct radiosity_settings *)&plan->settings;
}

#endif
