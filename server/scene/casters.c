#include "server/scene/casters.h"

#include <math.h>
#include <stdlib.h>

#include "server/scene/alias.h"
#include "server/scene/lights.h"

static double luminance(const float c[3])
{
	return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
}

// As make_glossy and glass_make of shaders/common see it.
double casters_strength(const struct material *m)
{
	const double alpha = (double)m->roughness * (double)m->roughness;
	const double bent = m->flags & MATERIAL_THIN ? 1 : fmin(fabs((double)m->ior - 1), 1);
	const double metal = m->metallic, rest = 1 - metal;
	if (m->flags & MATERIAL_UNLIT)
		return 0;
	const double glass = alpha * bent < GGX_ALPHA_LEAST ? (double)m->transmission * rest : 0;
	const double mirror = alpha < GGX_ALPHA_LEAST ? metal * luminance(m->albedo) + rest * luminance(m->specular) : 0;
	return fmin(fmax(glass, mirror), 1);
}

uint32_t casters_count(const struct blob_view *scene)
{
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	const struct material *materials = scene->sections[BLOB_MATERIALS];
	uint32_t count = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_TRIANGLES]; i++)
		count += casters_strength(&materials[triangles[i].material]) > 0;
	return count;
}

// Weights and triangle ids. Returns how many.
static uint32_t list_casters(const struct blob_view *scene, double *weights, struct emitter *rows)
{
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	const struct material *materials = scene->sections[BLOB_MATERIALS];
	const struct vertex *vertices = scene->sections[BLOB_VERTICES];
	uint32_t found = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_TRIANGLES]; i++) {
		const double strength = casters_strength(&materials[triangles[i].material]);
		const double weight = strength > 0 ? strength * lights_area(vertices, &triangles[i]) : 0;
		if (!isnormal(weight))
			continue;
		weights[found] = weight;
		rows[found++].triangle = i;
	}
	return found;
}

enum status casters_make_table(const struct blob_view *scene, struct emitter **out, uint32_t *count, float *density,
			       struct error *err)
{
	const struct material *materials = scene->sections[BLOB_MATERIALS];
	const uint32_t most = casters_count(scene);
	double sum = 0;
	enum status status = STATUS_MEMORY;

	*out = NULL;
	*count = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_MATERIALS]; i++)
		density[i] = 0;
	if (most == 0)
		return STATUS_OK;
	double *weights = calloc(most, sizeof *weights);
	struct alias_row *table = malloc(most * sizeof *table);
	struct emitter *rows = calloc(most, sizeof *rows);
	if (!weights || !table || !rows) {
		error_set(err, STATUS_MEMORY, "no memory for %u polished triangles", most);
		goto out;
	}
	const uint32_t found = list_casters(scene, weights, rows);
	status = alias_build(weights, found, table, &sum, err);
	for (uint32_t i = 0; i < found && status == STATUS_OK; i++) {
		rows[i].keep = table[i].keep;
		rows[i].alias = table[i].alias;
		rows[i].pmf = table[i].pmf;
	}
	for (uint32_t i = 0; i < scene->counts[BLOB_MATERIALS] && sum > 0; i++)
		density[i] = (float)fmin(casters_strength(&materials[i]) / sum, 1e30);
	if (status == STATUS_OK && found > 0) {
		*count = found;
		*out = rows;
		rows = NULL;
	}
out:
	free(rows);
	free(table);
	free(weights);
	return status;
}
