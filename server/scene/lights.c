#include "server/scene/lights.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "server/base/angle.h"
#include "server/base/luminance.h"
#include "server/base/vec3.h"
#include "server/scene/alias.h"
#include "server/scene/texel.h"

// Whether w may be a weight: the sum of all weights must fit a float, and a double that is not normal has lost digits.
static bool is_weight(double w)
{
	return w >= DBL_MIN && isfinite(w);
}

static double linear(uint32_t byte)
{
	const double v = byte / 255.0;
	return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

// The linear value of each step of a channel of 8 bits. A deep texel's is that of its high byte, rounded up so that no light
// is taken for none: for a weight that is enough.
static void fill_linear(const struct texture_info *t, double table[256])
{
	for (uint32_t i = 0; i < 256; i++)
		table[i] = t->flags & TEXTURE_SRGB ? linear(i) : i / 255.0;
}

static double linear_channel(const struct texture_info *t, const uint32_t *texels, const double table[256], size_t i,
			     unsigned c)
{
	return table[(texel_channel(t, texels, i, c) + 256u) / 257u];
}

static void mean_colour(const struct texture_info *t, const uint32_t *texels, double mean[3])
{
	const size_t count = (size_t)t->width * t->height;
	double table[256], sum[3] = {0, 0, 0};

	fill_linear(t, table);
	for (size_t i = 0; i < count; i++)
		for (unsigned c = 0; c < 3; c++)
			sum[c] += linear_channel(t, texels, table, i, c);
	for (int c = 0; c < 3; c++)
		mean[c] = sum[c] / (double)count;
}

void lights_texture_luminance(const struct texture_info *t, const uint32_t *texels, const float (*factors)[3],
			      uint32_t count, uint32_t width, uint32_t height, float *out)
{
	double table[256];
	fill_linear(t, table);
	for (uint32_t y = 0; y < t->height; y++)
		for (uint32_t x = 0; x < t->width; x++) {
			const size_t i = (size_t)y * t->width + x;
			const size_t row = (uint64_t)y * height / t->height, column = (uint64_t)x * width / t->width;
			float *cell = &out[(row * width + column) * count];
			double c[3];
			for (unsigned k = 0; k < 3; k++)
				c[k] = linear_channel(t, texels, table, i, k);
			for (uint32_t f = 0; f < count; f++)
				cell[f] += (float)luminance_of((double)factors[f][0] * c[0], (double)factors[f][1] * c[1],
							       (double)factors[f][2] * c[2]);
		}
	const double scale = (double)width * height / ((double)t->width * t->height);
	for (size_t i = 0; i < (size_t)width * height * count; i++)
		out[i] = (float)((double)out[i] * scale);
}

static float power_density(const struct material *m, const double mean[3])
{
	const double light = luminance_of(mean[0] * m->emission[0], mean[1] * m->emission[1], mean[2] * m->emission[2]);
	return (float)(PI * light * (m->flags & MATERIAL_EMITS_BOTH_SIDES ? 2.0 : 1.0));
}

static const double white[3] = {1, 1, 1};

float lights_power_density(const struct material *m, const struct texture_info *textures, const uint32_t *texels)
{
	double mean[3];
	if (m->emission_texture == NONE)
		return power_density(m, white);
	mean_colour(&textures[m->emission_texture], texels, mean);
	return power_density(m, mean);
}

// The mean colour of a texture's image, which several textures may show.
struct image_mean {
	const struct texture_info *texture; // the first that shows it; NULL: none yet
	double colour[3];
};

static bool same_image(const struct texture_info *a, const struct texture_info *b)
{
	return a->offset == b->offset && a->width == b->width && a->height == b->height &&
	       ((a->flags ^ b->flags) & (TEXTURE_SRGB | TEXTURE_DEEP)) == 0;
}

// The mean of texture t. means[i] is of the i-th image that was asked for.
static const double *mean_of_texture(const struct texture_info *t, const uint32_t *texels, struct image_mean *means)
{
	struct image_mean *m = means;
	while (m->texture && !same_image(m->texture, t))
		m++;
	if (!m->texture) {
		m->texture = t;
		mean_colour(t, texels, m->colour);
	}
	return m->colour;
}

enum status lights_power_densities(struct material *materials, uint32_t count, const struct texture_info *textures,
				   uint32_t texture_count, const uint32_t *texels, struct error *err)
{
	struct image_mean *means = calloc((size_t)texture_count + 1, sizeof *means);
	const double **of = calloc((size_t)texture_count + 1, sizeof *of); // textures that were met
	enum status status =
	    means && of ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for %u textures", texture_count);
	for (uint32_t i = 0; i < count && status == STATUS_OK; i++) {
		const uint32_t t = materials[i].emission_texture;
		if (t != NONE && !of[t])
			of[t] = mean_of_texture(&textures[t], texels, means);
		materials[i].power_density = power_density(&materials[i], t == NONE ? white : of[t]);
	}
	free(of);
	free(means);
	return status;
}

double lights_area(const struct vertex *vertices, const struct triangle *t)
{
	double n[3];
	vec3_across(vertices[t->vertex[0]].position, vertices[t->vertex[1]].position, vertices[t->vertex[2]].position, n);
	return 0.5 * sqrt(vec3_dot(n, n));
}

// List weights and triangle ids of emitters. Returns their number.
static uint32_t list_emitters(const struct material *materials, const struct vertex *vertices,
			      const struct triangle *triangles, uint32_t count, double *weights, struct emitter *out)
{
	uint32_t found = 0;
	for (uint32_t i = 0; i < count; i++) {
		const double density = materials[triangles[i].material].power_density;
		const double weight = density > 0 ? density * lights_area(vertices, &triangles[i]) : 0;
		if (!is_weight(weight))
			continue;
		weights[found] = weight;
		out[found++].triangle = i;
	}
	return found;
}

enum status lights_collect_emitters(const struct material *materials, const struct vertex *vertices,
				    const struct triangle *triangles, uint32_t count, struct emitter **out,
				    uint32_t *emitter_count, float *power, struct error *err)
{
	double sum = 0;
	uint32_t emissive = 0;
	enum status status = STATUS_MEMORY;

	*out = NULL;
	*emitter_count = 0;
	*power = 0;
	for (uint32_t i = 0; i < count; i++)
		emissive += materials[triangles[i].material].power_density > 0;
	if (emissive == 0)
		return STATUS_OK;
	double *weights = calloc(emissive, sizeof *weights);
	struct alias_row *rows = malloc(emissive * sizeof *rows);
	*out = calloc(emissive, sizeof **out);
	if (!weights || !rows || !*out) {
		error_set(err, STATUS_MEMORY, "no memory for %u emissive triangles", emissive);
		goto out;
	}
	const uint32_t found = list_emitters(materials, vertices, triangles, count, weights, *out);
	status = alias_build(weights, found, rows, &sum, err);
	for (uint32_t i = 0; i < found && status == STATUS_OK; i++) {
		(*out)[i].keep = rows[i].keep;
		(*out)[i].alias = rows[i].alias;
		(*out)[i].pmf = rows[i].pmf;
	}
	*emitter_count = found;
	*power = (float)fmin(sum, FLT_MAX);
out:
	free(rows);
	free(weights);
	if (status != STATUS_OK) {
		free(*out);
		*out = NULL;
	}
	return status;
}

float lights_range(double metres)
{
	return metres > 0 && metres <= LIMIT_COORDINATE ? fmaxf((float)metres, FLT_MIN) : 0;
}

static double light_weight(const struct punctual_light *l, double radius)
{
	const double value = luminance(l->intensity);
	if (l->kind == LIGHT_DIRECTIONAL)
		return value * PI * radius * radius;
	if (l->kind == LIGHT_SPOT)
		return value * PI * ((double)l->inner + (double)l->outer);
	return value * 4.0 * PI;
}

double lights_bounding_radius(const float min[3], const float max[3])
{
	double sum = 0;
	for (int i = 0; i < 3; i++)
		sum += ((double)max[i] - (double)min[i]) * ((double)max[i] - (double)min[i]);
	return sum > 0 ? 0.5 * sqrt(sum) : 1.0;
}

// Keep the lights that have a weight. Returns their number.
static uint32_t weigh(struct punctual_light *lights, uint32_t count, double radius, double *weights, uint32_t *place)
{
	uint32_t found = 0;
	for (uint32_t i = 0; i < count; i++) {
		const double weight = light_weight(&lights[i], radius);
		const bool counts = is_weight(weight);
		if (place)
			place[i] = counts ? found : NONE;
		if (!counts)
			continue;
		weights[found] = weight;
		lights[found++] = lights[i];
	}
	return found;
}

enum status lights_make_table(struct punctual_light *lights, uint32_t *count, double radius, uint32_t *place, float *power,
			      struct error *err)
{
	double sum = 0;
	enum status status = STATUS_OK;

	*power = 0;
	if (*count == 0)
		return STATUS_OK;
	double *weights = calloc(*count, sizeof *weights);
	struct alias_row *rows = malloc(*count * sizeof *rows);
	if (!weights || !rows) {
		status = error_set(err, STATUS_MEMORY, "no memory for %u lights", *count);
		goto out;
	}
	*count = weigh(lights, *count, radius, weights, place);
	status = alias_build(weights, *count, rows, &sum, err);
	for (uint32_t i = 0; i < *count && status == STATUS_OK; i++) {
		lights[i].keep = rows[i].keep;
		lights[i].alias = rows[i].alias;
		lights[i].pmf = rows[i].pmf;
	}
	*power = (float)fmin(sum, FLT_MAX);
out:
	free(rows);
	free(weights);
	return status;
}
