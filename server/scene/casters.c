#include "server/scene/casters.h"

#include <math.h>
#include <stdlib.h>

#include "server/base/luminance.h"
#include "server/scene/alias.h"
#include "server/scene/lights.h"
#include "server/scene/ranges.h"
#include "server/scene/texel.h"

// Number of texels sampled in each direction of a texture.
#define LOOKS 32u

// The strength that counts for a lobe of this α. It counts fully for a lobe that is not evaluated, because nothing else
// finds its light. It counts for other lobes if BSDF sampling finds their light badly.
static double lobe_strength(double strength, double alpha)
{
	if (alpha < GGX_ALPHA_LEAST)
		return strength;
	return alpha <= CASTERS_ALPHA_MOST && strength >= CASTERS_ROUGH_LEAST ? strength : 0;
}

// The strength of a material with this roughness and metalness, consistent with make_glossy, make_coat and glass_make in
// shaders/common.
static double strength_at(const struct material *m, double roughness, double metal)
{
	const double alpha = roughness * roughness, rest = 1 - metal;
	const double coat_alpha = (double)m->coat_roughness * (double)m->coat_roughness;
	const double bent = m->flags & MATERIAL_THIN ? 1 : fmin(fabs((double)m->ior - 1), 1);
	const double glass = lobe_strength((double)m->transmission * rest, alpha * bent);
	const double mirror = lobe_strength(metal * luminance(m->albedo) + rest * luminance(m->specular), alpha);
	const double coat = lobe_strength(0.04 * (double)m->coat, coat_alpha);
	return fmin(fmax(fmax(glass, mirror), coat), 1);
}

// A material without the lobes that its textures take away everywhere.
static struct material what_is_left(const struct blob_view *scene, const struct material *from)
{
	struct material m = *from;
	if (!(range_of_texture(scene, m.transmission_texture, 0).high > 0))
		m.transmission = 0;
	if (!(range_of_texture(scene, m.coat_texture, 0).high > 0))
		m.coat = 0;
	const bool weightless = !(range_of_texture(scene, m.specular_weight_texture, 3).high > 0);
	for (int c = 0; c < 3; c++)
		if (weightless || !(range_of_texture(scene, m.specular_texture, c).high > 0))
			m.specular[c] = 0;
	return m;
}

double casters_strength(const struct blob_view *scene, const struct material *material)
{
	const struct material left = what_is_left(scene, material), *const m = &left;
	if (m->flags & MATERIAL_UNLIT)
		return 0;
	if (m->surface_texture >= scene->counts[BLOB_TEXTURES])
		return strength_at(m, (double)m->roughness, (double)m->metallic);
	const struct texture_info *t = &((const struct texture_info *)scene->sections[BLOB_TEXTURES])[m->surface_texture];
	const uint32_t *texels = scene->sections[BLOB_TEXELS];
	const uint32_t across = t->width < LOOKS ? t->width : LOOKS, down = t->height < LOOKS ? t->height : LOOKS;
	double sum = 0;
	for (uint32_t y = 0; y < down; y++)
		for (uint32_t x = 0; x < across; x++) {
			const uint64_t row = (uint64_t)y * t->height / down, column = (uint64_t)x * t->width / across;
			const size_t i = (size_t)(row * t->width + column);
			sum += strength_at(m, (double)m->roughness * texel_channel(t, texels, i, 1) / 65535,
					   (double)m->metallic * texel_channel(t, texels, i, 2) / 65535);
		}
	return sum / ((double)across * down);
}

bool casters_has(const struct blob_view *scene, uint32_t material)
{
	return casters_strength(scene, &((const struct material *)scene->sections[BLOB_MATERIALS])[material]) > 0;
}

// casters_strength of each material. The caller frees it. NULL if there is no memory or no material.
static double *strengths_of(const struct blob_view *scene)
{
	const struct material *materials = scene->sections[BLOB_MATERIALS];
	double *strengths = calloc(scene->counts[BLOB_MATERIALS], sizeof *strengths);
	for (uint32_t i = 0; strengths && i < scene->counts[BLOB_MATERIALS]; i++)
		strengths[i] = casters_strength(scene, &materials[i]);
	return strengths;
}

static uint32_t count_casters(const struct blob_view *scene, const double *strengths)
{
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	uint32_t count = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_TRIANGLES]; i++)
		count += strengths[triangles[i].material] > 0;
	return count;
}

uint32_t casters_count(const struct blob_view *scene)
{
	double *strengths = strengths_of(scene);
	const uint32_t count = strengths ? count_casters(scene, strengths) : 0;
	free(strengths);
	return count;
}

// List weights and triangle ids. Returns their number.
static uint32_t list_casters(const struct blob_view *scene, const double *strengths, double *weights, struct emitter *rows)
{
	const struct triangle *triangles = scene->sections[BLOB_TRIANGLES];
	const struct vertex *vertices = scene->sections[BLOB_VERTICES];
	uint32_t found = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_TRIANGLES]; i++) {
		const double strength = strengths[triangles[i].material];
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
	double *strengths = strengths_of(scene), *weights = NULL, sum = 0;
	struct alias_row *table = NULL;
	struct emitter *rows = NULL;
	enum status status = STATUS_MEMORY;

	*out = NULL;
	*count = 0;
	for (uint32_t i = 0; i < scene->counts[BLOB_MATERIALS]; i++)
		density[i] = 0;
	if (!strengths)
		return error_set(err, STATUS_MEMORY, "no memory for %u materials", scene->counts[BLOB_MATERIALS]);
	const uint32_t most = count_casters(scene, strengths);
	if (most == 0) {
		status = STATUS_OK;
		goto out;
	}
	weights = calloc(most, sizeof *weights);
	table = malloc(most * sizeof *table);
	rows = calloc(most, sizeof *rows);
	if (!weights || !table || !rows) {
		error_set(err, STATUS_MEMORY, "no memory for %u polished triangles", most);
		goto out;
	}
	const uint32_t found = list_casters(scene, strengths, weights, rows);
	status = alias_build(weights, found, table, &sum, err);
	for (uint32_t i = 0; i < found && status == STATUS_OK; i++) {
		rows[i].keep = table[i].keep;
		rows[i].alias = table[i].alias;
		rows[i].pmf = table[i].pmf;
	}
	for (uint32_t i = 0; i < scene->counts[BLOB_MATERIALS] && sum > 0; i++)
		density[i] = (float)fmin(strengths[i] / sum, 1e30);
	if (status == STATUS_OK && found > 0) {
		*count = found;
		*out = rows;
		rows = NULL;
	}
out:
	free(rows);
	free(table);
	free(weights);
	free(strengths);
	return status;
}
