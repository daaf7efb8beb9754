// Interpolates indirect light from half to full resolution: a pixel takes that of the four nearest pixels that have it, as
// far as they lie on the same surface. Weights are bilinear, reduced for a different normal or plane (Kopf et al. 2007,
// "Joint bilateral upsampling"). A pixel without such neighbours traces its own cones.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "vct/half.glsl"
#include "vct/glass.glsl"

layout(local_size_x = TILE_PIXELS) in;
layout(binding = VCT_IRRADIANCE_UNIT) uniform sampler2D irradiance_texture;
layout(binding = VCT_FACETS_UNIT) uniform usampler2D facets_texture;

const float PLANE_PART = 0.02;    // tolerated distance off the plane, as a share of the distance between the two points
const float LEAST_WEIGHT = 0.05;

// The weight, 0…1, of a neighbour's light for this surface.
float kinship(surface s, vec3 normal, float breadth, uvec2 texel, vec4 irradiance, uvec4 facets)
{
	visible_point v = visible_ray(half_pixel(texel));
	vec3 apart = v.origin + irradiance.a * v.direction - s.position;
	float off = abs(dot(apart, s.geometric)) / (0.25 * breadth + PLANE_PART * length(apart));
	float turned = max(dot(normal, octahedral_unpack(facets.a)), 0.0);
	turned *= turned;
	turned *= turned;
	turned *= turned;
	return irradiance.a > 0.0 ? turned * turned * max(1.0 - off, 0.0) : 0.0;
}

bool blend(surface s, bsdf b, visible_point v, uvec2 pixel, out indirect r)
{
	vec2 at = vec2(pixel - uvec2(0u, area.x)) * 0.5;
	uvec2 base = uvec2(at);
	vec2 f = at - vec2(base);
	// The size of a pixel at the surface, in metres.
	float breadth = job.orthographic > 0.0 ? 1.0 : v.t;
	breadth *= 2.0 * length(to_vec3(job.up)) / float(job.height);
	r = indirect(vec3(0.0), vec3(0.0));
	float sum = 0.0;
	for (uint k = 0u; k < 4u; k++) {
		uvec2 step = uvec2(k & 1u, k >> 1);
		uvec2 texel = min(base + step, half_sides() - 1u);
		vec2 part = mix(1.0 - f, f, bvec2(step));
		vec4 irradiance = texelFetch(irradiance_texture, ivec2(texel), 0);
		uvec4 facets = texelFetch(facets_texture, ivec2(texel), 0);
		float w = part.x * part.y * kinship(s, b.normal, breadth, texel, irradiance, facets);
		r.irradiance += w * irradiance.rgb;
		r.facets += w * uintBitsToFloat(facets.rgb);
		sum += w;
	}
	r.irradiance /= max(sum, 1e-6);
	r.facets /= max(sum, 1e-6);
	return sum > LEAST_WEIGHT;
}

void main()
{
	uvec2 pixel;
	visible_point v;
	if (!pixel_mine(pixel) || !pixel_visible(pixel, v))
		return;
	surface s = pixel_surface(v);
	if (EFFECT_UNLIT && s.unlit)
		return;
	bsdf b = bsdf_make(s, v.direction);
	indirect r;
	if (!blend(s, b, v, pixel, r))
		r = indirect_at(s, b, pixel);
	pixel_add(pixel, indirect_radiance(b, r));
	pixel_add_glass(pixel, s, v);
}
