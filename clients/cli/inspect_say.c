#include "clients/cli/inspect_say.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <string.h>

#include "clients/cli/report.h"

#define MIB (1.0 / 1048576.0)

// What an imported solution has nothing for, as the answer names it.
static const char *const factor_things[] = {INSPECT_SHOW_RESIDUAL, INSPECT_SHOW_ROW, "factors", NULL};

uint32_t inspect_file_count(const struct inspect *inspect)
{
	if (!inspect->patches)
		return 0;
	return inspect->lacks_factors ? FILE_FACTORS : FILES;
}

const char *inspect_extension(const struct inspect *inspect)
{
	return inspect->job.options.request.format == CANDIL_FORMAT_PNG ? "png" : "exr";
}

bool inspect_name_files(struct inspect *inspect)
{
	static const char *const names[FILES] = {"patches.ply", "factors.mtx"};
	for (uint32_t i = 0; i < FILES; i++) {
		struct inspect_file *f = &inspect->files[i];
		errno = ENAMETOOLONG;
		if (snprintf(f->name, sizeof(f->name), "%s-%s", inspect->job.options.output, names[i]) >=
		    (int)sizeof(f->name))
			return false;
	}
	return true;
}

// ---- JSON ------------------------------------------------------------------------------------------------------------

static json_t *inspect_picture_json(const struct inspect *inspect, const struct inspect_picture *p)
{
	char name[PATH_MAX] = "";
	inspect_name(p, inspect->job.options.output, inspect_extension(inspect), name, sizeof(name));
	json_t *o = json_pack("{s:o,s:s,s:s}", "image", cli_json_text(name), "kind", p->kind, "show", p->show);
	if (!inspect->patches)
		json_object_set_new(o, "level", cli_json_u64(p->level));
	if (p->slice != INSPECT_NO_SLICE) {
		json_object_set_new(o, "axis", json_pack("s#", &"xyz"[p->axis], 1));
		json_object_set_new(o, "slice", cli_json_u64(p->slice));
	}
	json_object_set_new(o, "width", cli_json_u64(p->width));
	json_object_set_new(o, "height", cli_json_u64(p->height));
	json_object_set_new(o, "bytes", cli_json_u64(p->bytes));
	if (p->white > 0)
		json_object_set_new(o, "white", json_real(p->white));
	json_object_set_new(o, "elapsed_us", cli_json_u64(p->done.elapsed_us));
	json_object_set_new(o, "stages", report_stages_json(&p->done));
	return o;
}

static json_t *inspect_file_json(const struct inspect_file *f)
{
	json_t *o = json_pack("{s:o}", "file", cli_json_text(f->name));
	if (f->error.code != CANDIL_STATUS_OK) {
		json_object_set_new(o, "error", cli_json_text(f->error.text));
		return o;
	}
	json_object_set_new(o, "bytes", cli_json_u64(f->bytes));
	json_object_set_new(o, "elapsed_us", cli_json_u64(f->done.elapsed_us));
	json_object_set_new(o, "stages", report_stages_json(&f->done));
	return o;
}

// ---- the time of all of it -------------------------------------------------------------------------------------------

static void add_time(struct candil_done *sum, const struct candil_done *done)
{
	const uint32_t most = sizeof(sum->stages) / sizeof(sum->stages[0]);
	sum->elapsed_us += done->elapsed_us;
	sum->cold_us += done->cold_us;
	for (uint32_t i = 0; i < done->stage_count; i++) {
		uint32_t at = 0;
		while (at < sum->stage_count && strcmp(sum->stages[at].name, done->stages[i].name) != 0)
			at++;
		if (at < sum->stage_count)
			sum->stages[at].us += done->stages[i].us;
		else if (at < most)
			sum->stages[sum->stage_count++] = done->stages[i];
	}
}

// The first picture's answer, with the stages and the time of all pictures and files.
static void sum_up(const struct inspect *inspect, struct candil_done *sum)
{
	*sum = inspect->list.pictures[0].done;
	for (uint32_t i = 1; i < inspect->list.count; i++)
		add_time(sum, &inspect->list.pictures[i].done);
	for (uint32_t i = 0; i < inspect_file_count(inspect); i++)
		add_time(sum, &inspect->files[i].done);
}

json_t *inspect_answer_json(const struct inspect *inspect)
{
	struct candil_done all;
	sum_up(inspect, &all);
	json_t *images = json_array();
	for (uint32_t i = 0; i < inspect->list.count; i++)
		json_array_append_new(images, inspect_picture_json(inspect, &inspect->list.pictures[i]));
	json_t *answer =
	    json_pack("{s:o,s:o,s:s,s:o,s:s,s:o,s:o,s:o,s:o}", "scene", cli_json_text(inspect->job.options.scene),
		      "scene_hash", cli_json_text(inspect->job.target.info.hash), "technique",
		      candil_technique_name(inspect->job.accepted.technique), "device", cli_json_text(all.device), "format",
		      candil_format_name(inspect->job.options.request.format), "figures", report_figures_json(&all),
		      "stages", report_stages_json(&all), "elapsed_us", cli_json_u64(all.elapsed_us), "images", images);
	json_t *files = json_array();
	for (uint32_t i = 0; i < inspect_file_count(inspect); i++)
		json_array_append_new(files, inspect_file_json(&inspect->files[i]));
	json_object_set_new(answer, "files", files);
	json_t *left_out = json_array();
	for (size_t i = 0; inspect->lacks_factors && factor_things[i]; i++)
		json_array_append_new(left_out, json_string(factor_things[i]));
	json_object_set_new(answer, "left_out", left_out);
	job_put_warnings(&inspect->job, answer);
	return answer;
}

// ---- lines -----------------------------------------------------------------------------------------------------------

static void print_voxels(const struct candil_done *done)
{
	printf("grid       %g x %g x %g voxels of %.6g m, %.0f entries\n", inspect_figure(done, "grid.x"),
	       inspect_figure(done, "grid.y"), inspect_figure(done, "grid.z"), inspect_figure(done, "voxel"),
	       inspect_figure(done, "entries"));
	for (uint32_t i = 0, told = 0; i < done->figure_count; i++) {
		const struct candil_figure *f = &done->figures[i];
		if (strncmp(f->name, "occupied.", 9) == 0)
			printf("%s%.3g %%", told++ ? ", " : "occupied   by level, from the voxels up: ", 100 * f->value);
	}
	printf("\nmemory     %.2f MiB: voxels %.2f, light %.2f, pyramid %.2f\n", inspect_figure(done, "bytes.all") * MIB,
	       inspect_figure(done, "bytes.voxels") * MIB, inspect_figure(done, "bytes.light") * MIB,
	       inspect_figure(done, "bytes.pyramid") * MIB);
}

// How reciprocal the factors are. Rows by rays are samples, so that two patches disagree about the light that they exchange.
static void print_reciprocity(const struct candil_done *done)
{
	const double mean = inspect_figure(done, "reciprocity.mean"), chance = inspect_figure(done, "reciprocity.chance");
	if (!(chance > 0)) {
		printf("reciprocal to %.3g %% of the light exchanged; of single pairs to %.3g %%\n", 100 * mean,
		       100 * inspect_figure(done, "reciprocity.most"));
		return;
	}
	printf(
	    "reciprocal to %.3g %% of the light that two patches exchange, found from the one and from the other; rays by\n"
	    "           chance alone would make it %.3g %%. This is the noise of single factors, of which each has a few "
	    "of\n"
	    "           its row's rays, and no error of the picture: what all patches together send to one is known far\n"
	    "           better. More rays of a row make it less\n",
	    100 * mean, 100 * chance);
}

// What is white in pictures of light.
static void print_white(const struct inspect *inspect)
{
	const char *separator = "white      ";
	for (uint32_t i = 0; i < inspect->list.count; i++) {
		const struct inspect_picture *p = &inspect->list.pictures[i];
		if (p->white > 0) {
			printf("%s%.3g W/m² in %s", separator, p->white, p->show);
			separator = ", ";
		}
	}
	if (separator[0] == ',')
		puts("");
}

static void print_factors(const struct candil_done *done)
{
	printf("factors    %.0f in %.0f rows that light reaches; %.2f MiB in all that are kept\n",
	       inspect_figure(done, "check.factors"), inspect_figure(done, "check.rows"),
	       inspect_figure(done, "bytes.factors") * MIB);
	printf("row sums   %.6f … %.6f, mean %.6f; with what meets nothing %.6f … %.6f, mean %.6f\n",
	       inspect_figure(done, "sum.least"), inspect_figure(done, "sum.most"), inspect_figure(done, "sum.mean"),
	       inspect_figure(done, "sum.all.least"), inspect_figure(done, "sum.all.most"),
	       inspect_figure(done, "sum.all.mean"));
	print_reciprocity(done);
	printf("solved     to a residual of %.2e, in %.0f iterations\n", inspect_figure(done, "residual"),
	       inspect_figure(done, "iterations"));
}

static void print_patches(const struct inspect *inspect, const struct candil_done *done)
{
	printf("patches    %.0f, no side longer than %.6g m\n", inspect_figure(done, "patches"),
	       inspect_figure(done, "edge"));
	if (!inspect->lacks_factors) {
		print_factors(done);
		return;
	}
	printf("left out   ");
	for (size_t i = 0; factor_things[i]; i++)
		printf("%s%s", i ? ", " : "", factor_things[i]);
	puts(": what is imported is a solution, and has no form factors; a .mtx has them");
}

void inspect_print_answer(const struct inspect *inspect)
{
	const struct candil_done *done = &inspect->list.pictures[0].done;
	struct candil_done all;
	sum_up(inspect, &all);
	printf("images     %" PRIu32 ", %s-….%s; figures in %s.json\n", inspect->list.count, inspect->job.options.output,
	       inspect_extension(inspect), inspect->job.options.output);
	for (uint32_t i = 0; i < FILES; i++)
		if (inspect->files[i].bytes > 0)
			printf("file       %s, %" PRIu64 " bytes\n", inspect->files[i].name, inspect->files[i].bytes);
	print_white(inspect);
	if (inspect->patches)
		print_patches(inspect, done);
	else
		print_voxels(done);
	report_print_stages(&all, stdout);
	if (inspect->framed)
		puts("camera     the scene has none: its bounds are framed");
}

void inspect_print_lacking(const struct inspect *inspect)
{
	for (uint32_t i = 0; i < FILES; i++)
		if (inspect->files[i].error.code != CANDIL_STATUS_OK)
			fprintf(stderr, "candil: no %s: %s\n", inspect->files[i].name, inspect->files[i].error.text);
}
