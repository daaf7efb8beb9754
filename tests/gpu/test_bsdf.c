// Sampling against density: directions that the BSDF samples fill the hemisphere (a clear boundary's the whole sphere) as
// its own density says, by Pearson's χ² over 16 × 32 bins, at a significance of 0.01 for all configurations and seeds
// together (Šidák). And the density is one: it integrates to what is not lost, and the mean weight is the integral of the
// value.
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ggx_table.h"
#include "server/base/angle.h"
#include "shaders/bsdf_comp.h"
#include "tests/gpu/run_shader.h"

#define SAMPLES (1u << 18)
#define SIDE 1024u // of the grid of evaluated directions
#define Z_BINS 16u
#define PHI_BINS 32u
#define BINS (Z_BINS * PHI_BINS)
#define SEEDS 3u

struct config {
	float cosine, roughness, f0, diffuse, tilt, eta, matte, coat, coat_roughness,
	    coat_tilt; // as bsdf.comp.glsl has them
};

static const struct config configs[] = {
    {0.9f, 1.0f, 0.0f, 0.5f, 0.0f, .eta = 0},
    {0.3f, 1.0f, 0.0f, 0.5f, 0.4f, .eta = 0},
    {0.8f, 0.5f, 1.0f, 0.0f, 0.0f, .eta = 0},
    {0.8f, 0.4f, 0.04f, 0.5f, 0.0f, .eta = 0},
    {0.2f, 0.5f, 1.0f, 0.0f, 0.0f, .eta = 0},
    {0.5f, 0.7f, 0.5f, 0.8f, 0.5f, .eta = 0},
    {0.9f, 0.6f, 0.04f, 0.9f, -0.8f, .eta = 0},
    {0.05f, 0.8f, 0.9f, 0.3f, 0.0f, .eta = 0},
    {0.6f, 1.0f, 1.0f, 0.0f, 1.0f, .eta = 0},
    {0.9f, 0.5f, 0, 1, 0, .eta = 1.5f},
    {0.3f, 0.7f, 0, 1, 0, .eta = 1.5f},
    {0.7f, 1.0f, 0, 1, 0, .eta = 1 / 1.5f},
    {0.5f, 0.5f, 0, 1, 0, .eta = 1 / 1.5f},
    {0.1f, 0.8f, 0, 1, 0, .eta = 2.4f},
    {0.6f, 0.8f, 0, 1, 0, .eta = 1 / 2.4f},
    {0.7f, 0.6f, 0, 1, 0.7f, .eta = 1.5f},
    {0.5f, 0.6f, 0, 1, -0.5f, .eta = 0.7f},
    {0.8f, 0.5f, 0, 1, 0, .eta = -1.5f},
    {0.2f, 0.9f, 0, 1, 0.4f, .eta = -1.5f},
    {0.7f, 1, 0, 1, 0, .matte = 0.5f},
    {0.2f, 1, 0, 0.8f, 0, .matte = 1},
    {0.6f, 0.5f, 0.04f, 0.9f, 0.4f, .matte = 1},
    {0.8f, 1, 0, 0.6f, 0, .coat = 1, .coat_roughness = 0.5f},
    {0.3f, 0.6f, 1, 0, 0, .coat = 1, .coat_roughness = 0.8f},
    {0.7f, 0.4f, 0.04f, 0.7f, 0.6f, .matte = 0.5f, .coat = 0.7f, .coat_roughness = 0.6f},
    {0.4f, 0.8f, 0.5f, 0.5f, -0.5f, .coat = 1, .coat_roughness = 1, .coat_tilt = 0.4f},
};
#define CONFIGS (sizeof configs / sizeof *configs)

static const struct shader shader = {
    .name = "bsdf", .code = shader_bsdf_comp, .bytes = sizeof shader_bsdf_comp, .bindings = 2, .push_bytes = 52};

static float results[SIDE * SIDE][4];

static enum status run(struct shader_run *r, const struct config *c, uint32_t seed, uint32_t mode, uint32_t count,
		       struct error *err)
{
	struct {
		float cosine, roughness, f0, diffuse, tilt;
		uint32_t seed, mode, side;
		float eta, matte, coat, coat_roughness, coat_tilt;
	} push = {c->cosine, c->roughness, c->f0,    c->diffuse, c->tilt,           seed,        mode,
		  SIDE,      c->eta,       c->matte, c->coat,    c->coat_roughness, c->coat_tilt};
	enum status s = shader_run_dispatch(r, &push, sizeof push, count / 64, err);
	return s == STATUS_OK ? buffer_read(&r->out, r->device, 0, (mode ? 1u : 2u) * count * sizeof *results, results, err)
			      : s;
}

// z: the cosine, of a sphere's squeezed into 0…1.
static uint32_t bin_of(double z, double phi)
{
	const uint32_t zi = (uint32_t)fmin(fmax(z, 0) * Z_BINS, Z_BINS - 1);
	double turn = phi / (2 * PI);
	turn -= floor(turn);
	return zi * PHI_BINS + (uint32_t)fmin(turn * PHI_BINS, PHI_BINS - 1);
}

// Expected share of each bin, and the integrals of density, value and energy: what comes through, without the 1/η² of its
// radiance.
static void integrate(const struct config *c, double share[BINS], double *density, double *value, double *energy)
{
	const bool clear = c->eta != 0;
	const double eta2 = c->eta > 0 ? (double)c->eta * (double)c->eta : 1;
	const double solid_angle = (clear ? 4 : 2) * PI / ((double)SIDE * SIDE);
	memset(share, 0, BINS * sizeof *share);
	*density = *value = *energy = 0;
	for (uint32_t i = 0; i < SIDE * SIDE; i++) {
		const double z = (i / SIDE + 0.5) / SIDE, phi = 2 * PI * (i % SIDE + 0.5) / SIDE;
		share[bin_of(z, phi)] += (double)results[i][3] * solid_angle;
		*density += (double)results[i][3] * solid_angle;
		*value += (double)results[i][0] * solid_angle;
		*energy += (double)results[i][0] * solid_angle * (clear && z < 0.5 ? eta2 : 1);
	}
}

// Upper tail of χ² with k degrees: Wilson and Hilferty 1931.
static double tail(double chi2, double k)
{
	const double z = (cbrt(chi2 / k) - (1 - 2 / (9 * k))) / sqrt(2 / (9 * k));
	return 0.5 * erfc(z / sqrt(2.0));
}

static double test_counts(const double share[BINS], const uint32_t counts[BINS], uint32_t total)
{
	double chi2 = 0, rare_expected = 0, rare_seen = 0;
	uint32_t bins = 0;
	for (uint32_t i = 0; i < BINS; i++) {
		const double expected = share[i] * total;
		// Bins with few expected are taken together.
		if (expected < 20) {
			rare_expected += expected;
			rare_seen += counts[i];
			continue;
		}
		chi2 += (counts[i] - expected) * (counts[i] - expected) / expected;
		bins++;
	}
	if (rare_expected > 5) {
		chi2 += (rare_seen - rare_expected) * (rare_seen - rare_expected) / rare_expected;
		bins++;
	}
	return bins > 1 ? tail(chi2, bins - 1) : 0;
}

static bool test_config(struct shader_run *r, const struct config *c, double significance, struct error *err)
{
	double share[BINS], density, value, energy, mean = 0, least = 1;
	uint32_t taken = 0;
	if (run(r, c, 0, 1, SIDE * SIDE, err) != STATUS_OK)
		return false;
	integrate(c, share, &density, &value, &energy);
	for (uint32_t seed = 1; seed <= SEEDS; seed++) {
		uint32_t counts[BINS] = {0}, valid = 0;
		if (run(r, c, seed, 0, SAMPLES, err) != STATUS_OK)
			return false;
		for (uint32_t i = 0; i < SAMPLES; i++) {
			mean += (double)results[2 * i + 1][0] / (SAMPLES * (double)SEEDS);
			// A sample that the masking took away has no weight, and its density is none of the hemisphere's.
			if (!(results[2 * i + 1][0] > 0))
				continue;
			const double z = (double)results[2 * i][2];
			counts[bin_of(c->eta != 0 ? 0.5 * (z + 1) : z,
				      atan2((double)results[2 * i][1], (double)results[2 * i][0]))]++;
			valid++;
		}
		taken += valid;
		// Of all samples: what is lost below the surface is missing from the density as well.
		least = fmin(least, test_counts(share, counts, SAMPLES));
	}
	const double kept = taken / (SAMPLES * (double)SEEDS);
	const bool whole = c->eta == 0 || fabs(energy - 1) < 0.01;
	const bool good =
	    whole && least > significance && fabs(kept - density) < 0.005 && fabs(mean - value) < 0.005 && density < 1.003;
	printf("%s cosine %.2f roughness %.2f F0 %.2f diffuse %.2f tilt %.1f eta %.2f matte %.1f coat %.1f %.1f: p %.4f, "
	       "density %.4f of %.4f kept, mean "
	       "weight %.4f of %.4f, energy %.4f\n",
	       good ? "ok" : "FAIL", (double)c->cosine, (double)c->roughness, (double)c->f0, (double)c->diffuse,
	       (double)c->tilt, (double)c->eta, (double)c->matte, (double)c->coat, (double)c->coat_roughness, least, density,
	       kept, mean, value, energy);
	return good;
}

// The diffuse part and single scattering are the same both ways (Helmholtz); the factor that makes up for multiple
// scattering knows one direction, and does not claim to be.
static bool test_reciprocity(struct shader_run *r, const struct config *c, struct error *err)
{
	const uint32_t count = 1u << 16;
	double worst[2] = {0, 0};
	if (run(r, c, 1, 2, count, err) != STATUS_OK)
		return false;
	for (uint32_t i = 0; i < count; i++)
		for (int k = 0; k < 2; k++) {
			const double a = (double)results[i][2 * k], b = (double)results[i][2 * k + 1];
			if (a > 1e-6 || b > 1e-6)
				worst[k] = fmax(worst[k], fabs(a - b) / fmax(a, b));
		}
	const bool good = worst[0] < 1e-5 && worst[1] < 1e-4;
	printf("%s reciprocity, roughness %.2f F0 %.2f diffuse %.2f matte %.1f coat %.1f: diffuse part %.1e, single "
	       "scattering %.1e\n",
	       good ? "ok" : "FAIL", (double)c->roughness, (double)c->f0, (double)c->diffuse, (double)c->matte,
	       (double)c->coat, worst[0], worst[1]);
	return good;
}

int main(void)
{
	struct shader_run r;
	struct error err = {0};
	const double significance = 1 - pow(1 - 0.01, 1.0 / (CONFIGS * SEEDS));
	bool good = true;
	enum status s = shader_run_init(&r, &shader, ggx_table, sizeof ggx_table, sizeof results, &err);
	if (s == STATUS_DEVICE) {
		printf("skipped: %s\n", err.text);
		return 77;
	}
	for (size_t i = 0; s == STATUS_OK && i < CONFIGS; i++)
		good = test_config(&r, &configs[i], significance, &err) && good;
	for (size_t i = 0; s == STATUS_OK && i < CONFIGS; i++)
		good = test_reciprocity(&r, &configs[i], &err) && good;
	shader_run_finish(&r);
	if (s != STATUS_OK || err.code != STATUS_OK)
		printf("FAIL: %s\n", err.text);
	return good && s == STATUS_OK ? 0 : 1;
}
