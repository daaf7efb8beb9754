// What is seen through a clear surface. Rays follow the view from face to face, refracted at each as in glass.glsl, through
// sheets and bodies alike. They lose what the faces reflect, colour and absorb. Behind the last face, a cone reads what is
// there from the voxels; its width is the scattering of the roughest face. For smooth glass, the ray itself determines the
// distance: only the voxels about its hit are read, because a surface there hides all of so thin a cone. Scattering inside
// a rough body and reflections back into a body are left out, but total reflection is followed. The ray sees lamps that are
// not in the voxels, sharply.
#ifndef VCT_GLASS_GLSL
#define VCT_GLASS_GLSL

#include "trace/single.glsl"
#include "vct/indirect.glsl"

#define GLASS_FACES 8u          // most faces behind the first
#define GLASS_SMOOTH 0.02       // a cone with a tangent of its half aperture below this is a ray
#define GLASS_CELLS 2.0         // cells read before and behind a ray's hit

// Number of rays traced.
uint glass_rays = 0u;

struct glass_way {
	vec3 origin;
	vec3 direction;
	vec3 weight;
	vec3 absorption;   // of the current medium, 1/m
	float alpha;       // α of the roughest face, as a lobe about the ray
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
	// The direction is kept on its side of the true surface, however the shading normal is tilted.
	float above = dot(d, s.geometric);
	w.direction = through == (above > 0.0) ? d - 2.0 * above * s.geometric : d;
	w.origin = s.position + (through ? -s.offset : s.offset) * s.geometric;
	w.weight *= s.transmission * (through ? (1.0 - r) * s.base / (s.thin ? 1.0 : eta * eta) : vec3(1.0));
	if (through && !s.thin)
		w.absorption = leaves ? vec3(0.0) : to_vec3(materials[max(s.body, 1u) - 1u].absorption);
	w.alpha = max(w.alpha, s.roughness * s.roughness * (s.thin ? 1.0 : min(abs(eta - 1.0), 1.0)));
}

// Follows the ray through the faces behind. False if it leaves the scene; otherwise s is its last hit, `far` metres from
// the last face.
bool glass_follow(inout glass_way w, out surface s, out float far)
{
	for (uint i = 0u; i <= GLASS_FACES; i++) {
		ray_hit hit;
		glass_rays++;
		if (!walk_single(w.origin, w.direction, INFINITY, false, hit)) {
			// Inside a body, the ray finds no face to leave by: its weight becomes zero.
			w.weight = w.absorption == vec3(0.0) ? w.weight : vec3(0.0);
			return false;
		}
		s = surface_at(hit.id, hit.uv, w.origin, w.direction, hit.t);
		w.weight *= exp(-w.absorption * hit.t);
		far = hit.t;
		if (s.transmission < 0.5 || i == GLASS_FACES)
			break;
		glass_cross(w, s);
	}
	return true;
}

// What the voxels contain about a surface that a ray hit `far` metres away.
vec3 glass_met(cone_origin o, vec3 direction, float tangent, float far)
{
	float cells = far / vct_low_cell.w;
	o.start = max(cells - GLASS_CELLS, 0.0);
	vec4 c = cone_march_to(o, direction, tangent, cells + GLASS_CELLS);
	return c.a > 1e-3 ? c.rgb / (c.a * vct_background_scale.w) : vec3(0.0);
}

// Radiance, W/(m² sr), towards the camera through the surface that its ray `v` hits. `shift` is as in cone_from.
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
	// Clear faces are not in the voxels, so there is no plane to subtract.
	o.facing = vec3(0.0);
	float tangent = clamp(w.alpha, 0.0087, 1.0);
	vec3 radiance = cone_background(w.direction, tangent);
	if (tangent > GLASS_SMOOTH)
		radiance = cone_radiance(o, w.direction, tangent);
	else if (met)
		radiance = glass_met(o, w.direction, tangent, far);
	if (met && EFFECT_UNLIT && behind.unlit)
		radiance += behind.base;
	if (met && EFFECT_EMITTERS && vct_cones_emission.y == 0u)
		radiance += behind.emission;
	return w.weight * radiance;
}

// Adds to the pixel the light that comes through its surface, if it is clear.
void pixel_add_glass(uvec2 pixel, surface s, visible_point v)
{
	if (EFFECT_GLASS && s.transmission > 0.0)
		pixel_add_traced(pixel, glass_radiance(s, v, pixel_shift(pixel)), glass_rays, trace_cut);
}

#endif
