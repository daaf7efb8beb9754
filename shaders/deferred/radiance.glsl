// A pixel of a compute pass, and the radiance of the current sample in it. This file declares no storage block: Mesa counts
// every declared block, used or not, against the sixteen that a stage may have.
#ifndef DIRECT_RADIANCE_GLSL
#define DIRECT_RADIANCE_GLSL

#include "common/tile.glsl"
#include "deferred/area.glsl"

layout(binding = DEFERRED_RADIANCE_UNIT, rgba32f) uniform image2D radiance_image;

// The pixel of this invocation. False if it is outside of the image or of this dispatch.
bool pixel_mine(out uvec2 pixel)
{
	pixel = tile_pixel(area.z + gl_WorkGroupID.x, (turn.w + TILE_SIDE - 1u) / TILE_SIDE);
	return gl_WorkGroupID.x < area.w && pixel.x < turn.w && pixel.y < area.x + area.y;
}

// The texel of a pixel in the band's textures.
ivec2 pixel_texel(uvec2 pixel)
{
	return ivec2(pixel.x, pixel.y - area.x);
}

// Adds to the sample's radiance, W/(m² sr), and to its number of rays. `cut` says that the driver ended a walk.
void pixel_add_traced(uvec2 pixel, vec3 radiance, uint rays, bool cut)
{
	vec4 sum = imageLoad(radiance_image, pixel_texel(pixel));
	// A negative count marks that a walk was cut.
	float count = abs(sum.w) + float(rays);
	sum = vec4(sum.rgb + radiance, cut || sum.w < 0.0 ? -max(count, 1.0) : count);
	imageStore(radiance_image, pixel_texel(pixel), sum);
}

void pixel_add(uvec2 pixel, vec3 radiance)
{
	pixel_add_traced(pixel, radiance, 0u, false);
}

#endif
