// Rays of a pixel as its part of a set that VCT_SHARE_SIDE² pixels that trace, a block, have between them. Blocks have sets of
// their own: what one set misses is noise, and not the same pattern all over the picture.
#ifndef VCT_SHARED_RAYS_GLSL
#define VCT_SHARED_RAYS_GLSL

#include "vct/half.glsl"
#include "vct/rays.glsl"

layout(location = VCT_PIXEL_RAYS) uniform uvec3 pixel_rays;   // the first of this pass, the first that is not, and all

// What the rays of `range` (as pixel_rays) bring of a surface's irradiance / π. `pixel` is the image's, and `nearness` as in
// rays_irradiance.
vec3 shared_irradiance(surface s, bsdf b, uvec2 pixel, uvec3 range, inout float nearness)
{
	if (max(b.diffuse, vec3(0.0)) == vec3(0.0))
		return vec3(0.0);
	rays_origin o = rays_origin(s.position + s.offset * s.geometric, s.geometric, b.normal);
	uvec2 texel = pixel / VCT_EVERY;
	uvec2 block = texel / VCT_SHARE_SIDE;
	sampler_state random = sampler_make(block.y << 16 | block.x, turn.x, 0u, job.seed[0], job.seed[1]);
	uint part = turn.y * VCT_SHARE_SIDE * VCT_SHARE_SIDE + morton(texel % VCT_SHARE_SIDE);
	return rays_irradiance(o, random, part, range.x, range.y, range.z, nearness);
}

#endif
