// Whose light it is: with EFFECT_CAUSTICS, a lamp's light that comes to where the camera sees it by way of a polished surface
// is found by several ways, and each takes its share.
//
// Be a path from the camera's pixel to a lamp such that its first event spreads light, its last one, on a caster, hardly does
// (a mirror, clear glass, or a lobe whose density there is SHARP or more), and it has two or more. The camera's paths find it by
// chance, if they happen to meet the lamp, or by next-event estimation at the last event; these two know of each other. A
// light path (light.comp.glsl) goes it the other way and joins the camera at the first event. Veach's power heuristic (1997,
// 9.2.4) weighs the camera's ways together against the light's by the ratio of their densities,
//
//     r = light paths' / camera paths'.
//
// Any r whatever makes weights that add up to one, if all ways take the same: it is made of what all of them know. Ours is
// what r would be if all events in between spread light as Lambert's and if a bundle of rays kept its size from there to the last
// event. With n light paths a pixel sample, a the area that the pixel covers at the first event, c the density with which light
// paths meet the last event's place over the area across the ray from the lamp, f the density, by solid angle, of the camera's
// sampling at that event, and p that of next-event estimation's there, which it would be with lamps chosen by power,
//
//     r = n a π · c · f p / √(f² + p²).
//
// A mirror's f is infinite; so is the p of a lamp that chance does not meet. Where the first event's lobe is narrower than
// Lambert's, its own density over its cosine is there in place of 1/π. A small lamp is the light paths', one that fills half the
// view the camera's; point, spot and directional lights' light by way of mirrors is the former's alone. A surface that
// emits inside of two clear bodies is the camera's alone: a light path knows of the first when it comes out, and of the second too
// late. (A light there, which chance does not meet, is bent as if the first were in air.)
#ifndef PATH_CAUSTIC_GLSL
#define PATH_CAUSTIC_GLSL

#include "common/light.glsl"
#include "pt/lens.glsl"

// density[material]: of points that light paths are aimed at, 1/m².
layout(std430, set = 0, binding = BIND_CASTER_DENSITY) readonly buffer CasterDensity {
	float caster_density[];
};

// Of the light paths that leave a lamp as its light does or are aimed at a caster, the latter's share.
const float AIMED = 0.5;
// Density of a direction, 1/sr, from which on light paths go there too.
const float SHARP = 0.3;
// Keeps r² and 1 / r² numbers.
const float RIVALS_MOST = 1e15;

float aimed_share(bool afar)
{
	return job.caster_count == 0u ? 0.0 : afar ? 1.0 : AIMED;
}

// Whether a direction that was chosen, or might have been, with density `pdf` at this material is the light paths' too.
bool casts(uint material, float pdf)
{
	return pdf >= PDF_MIRROR || (pdf >= SHARP && caster_density[material] > 0.0);
}

// n a: at the first event, which the camera's ray met at distance t with this cosine.
float rivals_at(vec3 direction, float t, float cosine, uint paths)
{
	return float(paths) / max(pixels_per_area(direction, t, cosine), 1e-30);
}

// n a π, or what is in its place: the light goes on with this density from the first event.
float rivals_beside(float rivals, float pdf, float cosine)
{
	return rivals / max(pdf / max(cosine, 1e-30), 1.0 / PI);
}

// c, 1/m²: of light that by its lamp's own law comes with `spread`, and is aimed with `aimed`, the density over area divided by
// the cosine that the caster is met with.
float arriving(float spread, float aimed, bool afar)
{
	float share = aimed_share(afar);
	return (1.0 - share) * spread + share * aimed;
}

// c f p / √(f² + p²), `inverse` being 1/p.
float lamp_density(float arriving, float pdf, float inverse)
{
	float blur = pdf >= PDF_MIRROR ? 0.0 : 1.0 / pdf;
	return min(arriving / max(length(vec2(blur, inverse)), 1e-30), 1e30);
}

// The share that the camera's paths keep, …
float camera_keeps(float rivals, float lamp)
{
	return power_weight(clamp(rivals * lamp, 1.0 / RIVALS_MOST, RIVALS_MOST));
}

// … and the light path's.
float light_keeps(float rivals, float lamp)
{
	return power_weight(1.0 / clamp(rivals * lamp, 1.0 / RIVALS_MOST, RIVALS_MOST));
}

#endif
