// Writes the table of BIND_GGX_TABLE as a C array to standard output. Runs at build time.
//
// For a view cosine μ and roughness r (α = r²) the microfacet lobe with height-correlated Smith masking reflects
//     A + B = E(μ, α) = ∫ D G2 / (4 μ) dω          of white light where every facet reflects all,
//     F0 · A + F90 · B                             where facets follow Schlick's F0 + (F90 − F0)(1 − v·h)⁵.
// Both are means of G2 / G1 over visible normals (Heitz 2018, JCGT 7-4), weighted by 1 − (1 − v·h)⁵ and (1 − v·h)⁵, over a
// Hammersley set. The averages over the hemisphere are 2 ∫ μ A(μ) dμ.
//
// For a rough dielectric the table holds the mean of F G2 / G1 where the reflected direction is above the surface, plus
// (1 − F) G1(l) where the refracted one is below; and beside it, without either G, how often that is so:
// shaders/common/glass.glsl.
#include <math.h>
#include <stdint.h>
#include <stdio.h>

#include "shaders/shared/bindings.h"

#include "server/base/angle.h"

#define SAMPLES 2048u

static double radical_inverse(uint32_t i)
{
	double r = 0, digit = 0.5;
	for (; i; i >>= 1, digit /= 2)
		r += (i & 1) * digit;
	return r;
}

// Smith's Λ for a cosine.
static double lambda(double cosine, double alpha)
{
	const double c2 = cosine * cosine;
	return 0.5 * (sqrt(1 + alpha * alpha * (1 - c2) / c2) - 1);
}

// Visible normal by a spherical cap: Dupuy and Benyoub 2023.
static void visible_normal(const double v[3], double alpha, double u1, double u2, double h[3])
{
	double s[3] = {v[0] * alpha, v[1] * alpha, v[2]};
	const double l = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
	for (int i = 0; i < 3; i++)
		s[i] /= l;
	const double z = (1 - u2) * (1 + s[2]) - s[2], r = sqrt(fmax(0, 1 - z * z)), phi = 2 * PI * u1;
	h[0] = (r * cos(phi) + s[0]) * alpha;
	h[1] = (r * sin(phi) + s[1]) * alpha;
	h[2] = z + s[2];
	const double k = sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
	for (int i = 0; i < 3; i++)
		h[i] /= k;
}

static void albedo(double mu, double roughness, double out[2])
{
	const double alpha = fmax(roughness * roughness, GGX_ALPHA_LEAST);
	const double v[3] = {sqrt(fmax(0, 1 - mu * mu)), 0, mu};
	const double lambda_v = lambda(mu, alpha);
	out[0] = out[1] = 0;
	for (uint32_t i = 0; i < SAMPLES; i++) {
		double h[3];
		visible_normal(v, alpha, (i + 0.5) / SAMPLES, radical_inverse(i), h);
		const double vh = v[0] * h[0] + v[2] * h[2], lz = 2 * vh * h[2] - mu;
		if (lz <= 0 || vh <= 0)
			continue;
		const double ratio = (1 + lambda_v) / (1 + lambda_v + lambda(lz, alpha)), f = pow(1 - fmin(vh, 1), 5);
		out[0] += ratio * (1 - f) / SAMPLES;
		out[1] += ratio * f / SAMPLES;
	}
}

static double fresnel(double cosine, double eta)
{
	const double sine2 = (1 - cosine * cosine) / (eta * eta);
	if (sine2 >= 1)
		return 1;
	const double t = sqrt(1 - sine2);
	const double across = (cosine - eta * t) / (cosine + eta * t), along = (eta * cosine - t) / (eta * cosine + t);
	return (across * across + along * along) / 2;
}

static void glass_albedo(double mu, double roughness, double eta, double out[2])
{
	const double alpha = fmax(roughness * roughness, GGX_ALPHA_LEAST);
	const double v[3] = {sqrt(fmax(0, 1 - mu * mu)), 0, mu};
	const double lambda_v = lambda(mu, alpha);
	out[0] = out[1] = 0;
	for (uint32_t i = 0; i < SAMPLES; i++) {
		double h[3];
		visible_normal(v, alpha, (i + 0.5) / SAMPLES, radical_inverse(i), h);
		const double vh = fmin(v[0] * h[0] + v[2] * h[2], 1);
		if (vh <= 0)
			continue;
		const double f = fresnel(vh, eta), up = 2 * vh * h[2] - mu;
		if (up > 0) {
			out[0] += f * (1 + lambda_v) / (1 + lambda_v + lambda(up, alpha)) / SAMPLES;
			out[1] += f / SAMPLES;
		}
		const double t = sqrt(fmax(0, 1 - (1 - vh * vh) / (eta * eta)));
		const double down = (vh / eta - t) * h[2] - mu / eta;
		if (down < 0) {
			out[0] += (1 - f) / (1 + lambda(down, alpha)) / SAMPLES;
			out[1] += (1 - f) / SAMPLES;
		}
	}
}

static void print_glass(void)
{
	static double table[GLASS_RATIOS][GLASS_ROUGHNESSES][GLASS_COSINES][2];
	for (int e = 0; e < GLASS_RATIOS; e++) {
		const double x = e / (GLASS_RATIOS - 1.0) - 0.5, eta = (1 + x) / (1 - x);
		for (int r = 0; r < GLASS_ROUGHNESSES; r++)
			for (int c = 0; c < GLASS_COSINES; c++) {
				const double s = c / (GLASS_COSINES - 1.0), t = r / (GLASS_ROUGHNESSES - 1.0);
				glass_albedo(fmax(s * s, 1e-6), t * t, eta, table[e][r][c]);
			}
	}
	for (int k = 0; k < 2; k++)
		for (int e = 0; e + 1 < GLASS_RATIOS; e++)
			for (int r = 0; r < GLASS_ROUGHNESSES; r++)
				for (int c = 0; c < GLASS_COSINES; c++)
					printf("%.6ef, %.6ef,\n", table[e][r][c][k], table[e + 1][r][c][k]);
}

int main(void)
{
	static double table[GGX_ROUGHNESSES][GGX_COSINES][2];
	printf("static const float ggx_table[] = {\n");
	for (int r = 0; r < GGX_ROUGHNESSES; r++)
		for (int c = 0; c < GGX_COSINES; c++) {
			const double s = c / (GGX_COSINES - 1.0), t = r / (GGX_ROUGHNESSES - 1.0);
			albedo(fmax(s * s, 1e-6), t * t, table[r][c]);
			printf("%.9ef, %.9ef,\n", table[r][c][0], table[r][c][1]);
		}
	for (int r = 0; r < GGX_ROUGHNESSES; r++) {
		// Trapezoids in s with μ = s², dμ = 2 s ds: 2 ∫ μ A dμ = 4 ∫ s³ A ds.
		double sum[2] = {0, 0};
		for (int c = 0; c < GGX_COSINES; c++) {
			const double s = c / (GGX_COSINES - 1.0), w = (c == GGX_COSINES - 1 ? 0.5 : 1) / (GGX_COSINES - 1.0);
			for (int k = 0; k < 2; k++)
				sum[k] += 4 * s * s * s * table[r][c][k] * w;
		}
		printf("%.9ef, %.9ef,\n", sum[0], sum[1]);
	}
	print_glass();
	printf("};\n");
	return 0;
}
