// The report on a finished render.
#ifndef CANDIL_CLI_REPORT_H
#define CANDIL_CLI_REPORT_H

#include "clients/cli/render_options.h"

struct report {
	const struct render_options *options;
	const struct candil_scene_info *scene;
	const char *camera; // where it came from: "scene", "given" or "framed"
	struct candil_accepted accepted;
	struct candil_done done;
	uint64_t bytes; // of the image
	uint32_t made_width, made_height; // pixels that it was made of
	unsigned images; // how many were written, intermediate ones included
};

#define REPORT_JSON_HELP \
	"{\"image\", \"format\", \"width\", \"height\", \"made_width\", \"made_height\" (pixels that were\n" \
	"rendered: fewer than these, scaled up, where --time left none for more), \"bytes\", \"images\", \"samples\", " \
	"\"first_sample\", \"seed\",\n" \
	"\"scene\", \"scene_hash\", \"camera\": {\"source\": \"scene\"|\"given\"|\"framed\", " \
	"\"name\", \"eye\",\n" \
	"\"target\", \"up\", \"vfov_degrees\"}, \"technique\", \"depth\" (how often light scatters at most;\n" \
	"65535: until next to nothing is left), \"device\", \"job_bytes\",\n" \
	"\"effects\": [{\"name\", \"state\", \"why\", where measured \"cost_us\", \"share\"}],\n" \
	"\"warnings\": [] (about the scene), \"warnings_more\", \"notes\": [], \"default_light\" (whether it was given),\n" \
	"\"verdict\": {\"black\", \"clipped\", \"missed\"} (shares of the pixels; null: it is no picture), \"stages\": " \
	"[{\"name\", \"us\"}],\n" \
	"\"elapsed_us\", \"cold_us\" (of these: compiling, which a second render is spared),\n" \
	"\"error_kind\": \"measured\"|\"predicted\"|\"unknown\", \"estimated_relmse\", \"relmse_low\", \"relmse_high\"\n" \
	"(null: unknown, or no upper end),\n" \
	"\"non_finite_samples\", \"rays\", \"slices\", \"retries\", \"reason\",\n" \
	"\"figures\": [{\"name\", \"value\", \"unit\"}] (of the technique, if it has any), \"quote\" (that auto chose " \
	"the\n" \
	"technique by, as of candil quote; null: nothing was chosen)}\n"

// The stages, [{"name", "us"}], and the figures, [{"name", "value", "unit"}], of a finished render.
json_t *report_stages_json(const struct candil_done *done);
json_t *report_figures_json(const struct candil_done *done);

// The verdict on a picture, {"black", "clipped", "missed"}.
json_t *report_verdict_json(const struct candil_verdict *verdict);

// Print a line such as "time       12.3 ms: queue 0.0, …".
void report_print_stages(const struct candil_done *done, FILE *stream);

// The error, its interval and how it is known: a line, and keys of the object, null where unknown.
void report_print_error(const struct candil_done *done, FILE *stream);
void report_put_error(json_t *object, const struct candil_done *done);

// The whole report as lines and as one object.
void report_print(const struct report *report, FILE *stream);
json_t *report_json(const struct report *report);

#endif
