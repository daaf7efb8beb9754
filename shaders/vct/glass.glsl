// What is seen through a clear surface. The view goes on by rays from face to face, bent at each as glass.glsl has it, through
// sheets and bodies alike, and loses what they reflect, colour and absorb. Behind the last face a cone takes what is there out
// of the voxels, as wide as the roughest face scatters. Of smooth glass the ray that went on tells where that is: only the
// voxels about what it met are asked, for a surface there hides all of so thin a cone.
// What a rough body does to light on its way inside, and what the faces reflect back into it, is left out; but total
// reflection is followed. Lamps that are not in the voxels are seen by the ray, sharp.
#ifndef VCT_GLASS_GLSL
#define VCT_GLASS_GLSL

#include "trace/single.glsl"
#include "vct/indirect.glsl"

#define GLASS_FACES 8u          // behind the first
#define GLASS_SMOOTH 0.02       // tangent of the cone's half aperture below which it is a ray
#define GLASS_CELLS 2.0         // about what a ray met

// Rays that it took.
uint glass_rays = 0u;

struct glass_way {
	vec3 origin;
	vec3 direction;
	vec3 weight;
	vec3 absorption;   // of what it is in, 1/m
	float alpha;       // of the roughest face, of a lobe about the ray
};

void glass_cross(inout glass_way w, surface s)
{
	bool leaves = !s.thin && !s.front;
	float eta = leaves ? 1.0 / s.ior : s.ior;
	float r = fresnel_dielectric(max(-dot(s.shading, w.direction), 1e-3), eta);
	r = s.thin ? 2.0 * r / (1.0 + r) : r;
	vec3 bent = s.thin ? w.direction : refract(w.direction, s.shading, 1.0 / eta);
	bool through = bent != vec3(0.0) && r < 1.0;
	vec3 d = normalize(through ? bent : reflect(w.direction, s.shading));
	// Kept on its side of the true surface, whichever way the shading normal leans.
	float above = dot(d, s.geometric);
	w.direction = through == (above > 0.0) ? d - 2.0 * above * s.geometric : d;
	w.origin = s.position + (through ? -s.offset : s.offset) * s.geometric;
	w.weight *= s.transmission * (through ? (1.0 - r) * s.base / (s.thin ? 1.0 : eta * eta) : vec3(1.0));
	if (through && !s.thin)
		w.absorption = leaves ? vec3(0.0) : to_vec3(materials[max(s.body, 1u) - 1u].absorption);
	w.alpha = max(w.alpha, s.roughness * s.roughness * (s.thin ? 1.0 : min(abs(eta - 1.0), 1.0)));
}

// Along the way's ray through the faces behind: what it met last, if anything. `far`: metres from the last face to it.
bool glass_follow(inout glass_way w, out surface s, out float far)
{
	for (uint i = 0u; i <= GLASS_FACES; i++) {
		ray_hit hit;
		glass_rays++;
		if (!walk_single(w.origin, w.direction, INFINITY, false, hit)) {
			// Not out of the body: there is no face to leave it by.
			w.weight = w.absorption == vec3(0.0) ? w.weight : vec3(0.0);
			return false;
		}
		s = surface_at(hit.id, hit.uv, w.direction);
		w.weight *= exp(-w.absorption * hit.t);
		far = hit.t;
		if (s.transmission < 0.5 || i == GLASS_FACES)
			break;
		glass_cross(w, s);
	}
	return true;
}

// What the voxels have about a surface that a ray met `far` metres away.
vec3 glass_met(cone_origin o, vec3 direction, float tangent, float far)
{
	float cells = far / vct_low_cell.w;
	o.start = max(cells - GLASS_CELLS, 0.0);
	vec4 c = cone_march_to(o, direction, tangent, cells + GLASS_CELLS);
	return c.a > 1e-3 ? c.rgb / (c.a * vct_background_scale.w) : vec3(0.0);
}

// Radiance towards the camera through the surface that its ray `v` meets. `shift`: as cone_from's.
vec3 glass_radiance(surface s, visible_point v, float shift)
{
	glass_way w = glass_way(v.origin, v.direction, vec3(1.0), vec3(0.0), 0.0);
	if (!s.thin && !s.front)
		w.weight = exp(-to_vec3(materials[max(s.body, 1u) - 1u].absorption) * v.t);
	glass_cross(w, s);
	surface behind;
	float far;
	bool met = glass_follow(w, behind, far);
	cone_origin o = cone_from(w.origin, w.direction, shift);
	// Clear faces are not in the voxels: there is no plane to take out.
	o.facing = vec3(0.0);
	float tangent = clamp(w.alpha, 0.0087, 1.0);
	vec3 radiance = cone_background(w.direction, tangent);
	if (tangent > GLASS_SMOOTH)
		radiance = cone_radiance(o, w.direction, tangent);
	else if (met)
		radiance = glass_met(o, w.direction, tangent, far);
	if (met && EFFECT_UNLIT && behind.unlit)
		radiance += behind.base;
	if (met && EFFECT_EMITTERS && vct_reach_emission.y == 0u)
		radiance += behind.emission;
	return w.weight * radiance;
}

// To the pixel what comes through its surface, if it is clear.
void pixel_add_glass(uvec2 pixel, surface s, visible_point v)
{
	if (EFFECT_GLASS && s.transmission > 0.0)
		pixel_add_traced(pixel, glass_radiance(s, v, pixel_shift(pixel)), glass_rays, trace_cut);
}

#endif
