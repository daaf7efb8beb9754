// Indirect light of every second pixel of every second row, or of every pixel (VCT_EVERY), in two textures: (irradiance / π,
// distance along the pixel's ray) and, as words, (incoming radiance for the facets, packed shading normal). Distance 0: nothing
// there.
#ifndef VCT_HALF_GLSL
#define VCT_HALF_GLSL

#include "vct/indirect.glsl"
#include "voxel/octahedral.glsl"

// Pixels between two that have light of their own; a macro that the program defines.
#ifndef VCT_EVERY
#define VCT_EVERY 2u
#endif

const float PLANE_PART = 0.02;    // tolerated distance off the plane, as a share of the distance between the two points

// Texels that cover the pixels of the band.
uvec2 half_sides()
{
	return (uvec2(turn.w, area.y) + VCT_EVERY - 1u) / VCT_EVERY;
}

// The pixel that a texel represents.
uvec2 half_pixel(uvec2 texel)
{
	return VCT_EVERY * texel + uvec2(0u, area.x);
}

// The texel of this invocation. Its tiles are counted from the band's first one. False if it is outside of the band or of this
// dispatch.
bool half_mine(out uvec2 texel)
{
	uvec2 sides = half_sides();
	uint columns = (turn.w + TILE_SIDE - 1u) / TILE_SIDE;
	uint tile = area.z + gl_WorkGroupID.x - area.x / TILE_SIDE * columns;
	texel = tile_pixel(tile, (sides.x + TILE_SIDE - 1u) / TILE_SIDE);
	return gl_WorkGroupID.x < area.w && texel.x < sides.x && texel.y < sides.y;
}

// The size of a pixel at a point so many metres along its ray, in metres.
float half_breadth(float t)
{
	return (job.orthographic > 0.0 ? 1.0 : t) * 2.0 * length(to_vec3(job.up)) / float(job.height);
}

// From a place to the one that a texel represents, metres.
vec3 half_apart(vec3 position, uvec2 texel, float t)
{
	visible_point v = visible_ray(half_pixel(texel));
	return v.origin + t * v.direction - position;
}

// The weight, 0…1, of a texel's light for a place of these two normals: less for another plane or another shading normal.
float half_kinship(vec3 apart, vec3 geometric, vec3 normal, float breadth, vec4 irradiance, uvec4 facets)
{
	float off = abs(dot(apart, geometric)) / (0.25 * breadth + PLANE_PART * length(apart));
	float turned = max(dot(normal, octahedral_unpack(facets.a)), 0.0);
	turned *= turned;
	turned *= turned;
	turned *= turned;
	return irradiance.a > 0.0 ? turned * turned * max(1.0 - off, 0.0) : 0.0;
}

#endif
