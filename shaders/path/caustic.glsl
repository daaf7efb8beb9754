// Whose light it is: with EFFECT_CAUSTICS, a lamp's light that comes to where the camera sees it by way of a polished surface
// is found by two ways, and each takes its share.
//
// Be a path from the camera's pixel to a point of an emissive triangle such that its first event spreads light, its last one
// does not (a perfect mirror, smooth glass), and it has two or more. The camera's path finds it by chance: it must happen to
// meet the lamp. A light path (light.comp.glsl) goes it the other way and joins the camera at the first event. No other way of
// sampling finds it. Veach's power heuristic (1997, 9.2.4) weighs the two by the ratio of their densities,
//
//     r = light paths' / camera paths'.
//
// Any r whatever makes weights that add up to one, if both ways take the same. Ours is what r would be if all events in between
// spread light as Lambert's and if a bundle of rays kept its size from end to end, so that it takes nothing but the path's
// ends: with n light paths a pixel sample, a the area that the pixel covers at the first event, p the density over area of the
// lamp's point and w that over solid angle of the light path's first direction, at the angle θ from the lamp's normal,
//
//     r = n a · p · π w / cos θ.
//
// A small lamp is the light paths', one that fills half the view the camera's. Punctual lights are the former's alone.
#ifndef PATH_CAUSTIC_GLSL
#define PATH_CAUSTIC_GLSL

#include "common/light.glsl"
#include "path/lens.glsl"

// density[material]: of points that light paths are aimed at, 1/m².
layout(std430, set = 0, binding = BIND_CASTER_DENSITY) readonly buffer CasterDensity {
	float caster_density[];
};

// Of the light paths that leave a lamp as its light does or are aimed at a caster, the latter's share.
const float AIMED = 0.5;
// Keeps r² and 1 / r² numbers.
const float RIVALS_MOST = 1e15;

float aimed_share()
{
	return job.caster_count > 0u ? AIMED : 0.0;
}

// n a π: at the first event, which the camera's ray met at distance t with this cosine.
float rivals_at(vec3 direction, float t, float cosine, uint paths)
{
	return PI * float(paths) / max(pixels_per_area(direction, t, cosine), 1e-30);
}

// p w / cos θ: w has two parts, Lambert's cosine and what is aimed, whose density by area is `density` where the caster is met
// with the cosine `cos_caster` at distance t.
float lamp_density(float pdf_area, float cos_lamp, float density, float cos_caster, float t)
{
	float a = aimed_share();
	float aimed = a * density * t * t / max(cos_caster * cos_lamp, 1e-30);
	return pdf_area * ((1.0 - a) / PI + min(aimed, 1e30));
}

// The share that the camera's path keeps, …
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
