// A pass over tiles: what the camera sees of lamps, background and unlit surfaces, and the direct light on all other
// surfaces. A program that takes surfaces for something else defines LIGHT_SURFACE, a function in the place of pixel_surface.
#ifndef DIRECT_LIGHT_PIXEL_GLSL
#define DIRECT_LIGHT_PIXEL_GLSL

#include "direct/lamp_image.glsl"
#include "deferred/pixel.glsl"
#ifdef DIRECT_SKY
#include "common/sky_map.glsl"
#endif

#ifndef LIGHT_SURFACE
#define LIGHT_SURFACE pixel_surface
#endif

void light_pixel()
{
	uvec2 pixel;
	visible_point v;
	if (!pixel_mine(pixel))
		return;
	if (DIRECT_SOFT)
		imageStore(scale_image, pixel_texel(pixel), vec4(0.0));
	if (!pixel_visible(pixel, v)) {
#ifdef DIRECT_SKY
		pixel_add(pixel, sky_seen(v.direction, job.sky_turn) * job.sky_scale);
#else
		if (EFFECT_ENVIRONMENT)
			pixel_add(pixel, to_vec3(job.background));
#endif
		return;
	}
	surface s = LIGHT_SURFACE(v);
	if (EFFECT_UNLIT && s.unlit) {
		pixel_add(pixel, s.emission + s.base);
		return;
	}
	bsdf b = bsdf_make(s, v.direction);
	direct_place = pixel.y * turn.w + pixel.x;
	lamp_light lamps;
	vec3 radiance =
		direct_light_parts(s, b, s.position + s.offset * s.geometric, direct_pattern(pixel), lamps) + s.emission;
	if (DIRECT_SOFT)
		keep_lamps(pixel_texel(pixel), lamps, b, v.t, s.geometric);
	else
		radiance += lamps.facets + lamp_radiance(lamps);
	pixel_add_traced(pixel, radiance, direct_rays, trace_cut);
}

#endif
