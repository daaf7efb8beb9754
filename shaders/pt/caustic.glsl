// Weights of caustics. With EFFECT_CAUSTICS, several techniques find the light of a lamp that reaches a visible surface by
// way of a polished one. This file computes the weight of each.
//
// The weights concern paths from a pixel to a lamp with two or more events, of which the first spreads light, and the last
// is on a caster and hardly does: a mirror, clear glass, or a lobe whose density there is SHARP or more. The camera's paths
// find such a path by BSDF sampling, if they happen to hit the lamp, or by next-event estimation at the last event; these
// two are already weighted against each other. A light path (light.comp.glsl) takes it the other way and connects to the
// camera at the first event. The power heuristic (Veach 1997, 9.2.4) weights the camera's techniques together against the
// light path by the ratio of their densities,
//
//     r = density of light paths / density of camera paths.
//
// Weights add up to one for any r, provided that all techniques use the same. So r is made only of quantities that all of
// them know. It is the ratio that would hold if all events in between scattered light like Lambert's law and if a bundle of
// rays kept its cross-section from there to the last event:
//
//     r = n a π · c · f p / √(f² + p²).
//
// n is the number of light paths per pixel sample. a is the area that the pixel covers at the first event. c is the density
// with which light paths reach the place of the last event, over the area perpendicular to the ray from the lamp. f is the
// density, by solid angle, of the camera's BSDF sampling at that event. p is the density of next-event estimation there, as
// if lamps were chosen by power.
//
// f is infinite for a mirror, and p for a lamp that BSDF sampling cannot hit. Where the lobe of the first event is narrower
// than Lambert's, its density divided by its cosine takes the place of 1/π. So a small lamp is left to light paths, and one
// that fills half the view to the camera's paths. The light of point, spot and directional lights by way of mirrors is
// found by light paths alone. A surface that emits inside two clear bodies is left to the camera's paths alone: a light
// path learns of the first body when it leaves it, and of the second too late. (The light of a point or spot light there is
// refracted as if the first body were in air, since BSDF sampling cannot hit it.)
#ifndef PATH_CAUSTIC_GLSL
#define PATH_CAUSTIC_GLSL

#include "common/light.glsl"
#include "pt/lens.glsl"
#include "shared/pt.h"

// caster_density[material]: density, 1/m², of the points of this material at which light paths are aimed.
layout(std430, set = 0, binding = BIND_CASTER_DENSITY) readonly buffer CasterDensity {
	float caster_density[];
};

// The share of light paths from a lamp that are aimed at a caster; the rest leave the lamp as its light does.
const float AIMED = 0.5;
// Density of a direction, 1/sr, from which on light paths find it too.
const float SHARP = 0.3;
// Bound of r and 1 / r, so that their squares stay finite.
const float RIVALS_MOST = 1e15;

float aimed_share(bool afar)
{
	return job.caster_count == 0u ? 0.0 : afar ? 1.0 : AIMED;
}

// Whether light paths also find a direction that is sampled with density `pdf`, 1/sr, at this material.
bool casts(uint material, float pdf)
{
	return pdf >= PDF_MIRROR || (pdf >= SHARP && caster_density[material] > 0.0);
}

// n a at the first event, which the camera's ray hit at distance t with this cosine.
float rivals_at(vec3 direction, float t, float cosine, uint paths)
{
	return float(paths) / max(pixels_per_area(direction, t, cosine), 1e-30);
}

// n a π, or what takes its place if the first event scatters into its direction with density `pdf`, 1/sr.
float rivals_beside(float rivals, float pdf, float cosine)
{
	return rivals / max(pdf / max(cosine, 1e-30), 1.0 / PI);
}

// c, 1/m². `spread` is the density by the lamp's own law of emission. `aimed` is the density over a caster's area divided
// by the cosine at which it is hit.
float arriving(float spread, float aimed, bool afar)
{
	float share = aimed_share(afar);
	return (1.0 - share) * spread + share * aimed;
}

// c f p / √(f² + p²); `pdf` is f and `inverse` is 1/p.
float lamp_density(float arriving, float pdf, float inverse)
{
	float blur = pdf >= PDF_MIRROR ? 0.0 : 1.0 / pdf;
	return min(arriving / max(length(vec2(blur, inverse)), 1e-30), 1e30);
}

// The weight of the camera's paths.
float camera_keeps(float rivals, float lamp)
{
	return power_weight(clamp(rivals * lamp, 1.0 / RIVALS_MOST, RIVALS_MOST));
}

// The weight of the light path.
float light_keeps(float rivals, float lamp)
{
	return power_weight(1.0 / clamp(rivals * lamp, 1.0 / RIVALS_MOST, RIVALS_MOST));
}

#endif
