// What the voxels know of a place on a triangle where a ray has landed: what the entry of its voxel and layer reflects, and
// emits if the pyramid would have it. The layer is the triangle's and the side the ray's, so nothing of a thin wall's other
// side is found.
//
// The voxel is that of a place nearby, chosen by chance within one voxel's breadth in the triangle's plane. So the mean of
// many rays goes over smoothly from one voxel to the next.
#ifndef VCT_LANDED_GLSL
#define VCT_LANDED_GLSL

#include "common/sampling.glsl"
#include "common/surface.glsl"
#include "vct/params.glsl"
#include "voxel/grid_block.glsl"

#ifndef VCT_REFLECTS
#define VCT_REFLECTS true     // else surfaces reflect none of the light on them: no bounce
#endif
#ifndef VCT_EMITS
#define VCT_EMITS false       // emission is found by rays, rather than by points on lamps
#endif

layout(binding = VCT_WORDS_UNIT) uniform usamplerBuffer vct_words;
layout(binding = VCT_ALBEDO_UNIT) uniform usamplerBuffer vct_albedo;
layout(binding = VCT_SENT_UNIT) uniform samplerBuffer vct_sent;
layout(binding = VCT_EMISSION_UNIT) uniform usamplerBuffer vct_emission;

// Voxels, across a triangle: rounding moves a place less than this out of the voxel that the triangle was put into.
const float LANDED_ROUNDING = 0.01;

// The entry of a place in voxels, or NONE: as voxel_entry of voxel/lookup.glsl.
uint landed_entry(vec3 place, uint layer)
{
	ivec3 cell = ivec3(floor(place));
	ivec3 sides = ivec3(grid_sides_entries.xyz);
	if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, sides)))
		return NONE;
	uint bit = 2u * uint(cell.x + sides.x * (cell.y + sides.y * cell.z)) + layer;
	int at = int(bit >> 5) * 2;
	uint word = texelFetch(vct_words, at).x;
	uint own = 1u << (bit & 31u);
	return (word & own) != 0u ? texelFetch(vct_words, at + 1).x + uint(bitCount(word & own - 1u)) : NONE;
}

// The layer of a triangle by its normal: as layer_of of voxel/grid.glsl.
uint landed_layer(vec3 normal)
{
	vec3 a = abs(normal);
	float largest = a.z >= max(a.x, a.y) ? normal.z : a.x > a.y ? normal.x : normal.y;
	return largest < 0.0 ? 1u : 0u;
}

// Whether an entry's back emits: as voxel_emits_back.
bool landed_emits_back(uint entry)
{
	uvec4 bits = texelFetch(vct_emission, int(grid_sides_entries.w + entry / VOXEL_BACK_BITS));
	return (bits[entry / 32u % 4u] >> entry % 32u & 1u) != 0u;
}

// Radiance, W/(m² sr), against `direction` from the place p (metres) on triangle `id`. `chance` is in the unit square.
vec3 landed_radiance(uint id, vec3 p, vec3 direction, vec2 chance)
{
	vec3 normal = corners_of(triangles[id]).normal;
	uint layer = landed_layer(normal);
	vec3 x, y;
	frame_make(normal, x, y);
	vec3 at = (p - grid_low_side.xyz) / grid_low_side.w;
	vec3 aside = (chance.x - 0.5) * x + (chance.y - 0.5) * y;
	uint entry = landed_entry(at + aside, layer);
	// There is none where the surface ends or bends away; then the place itself has one.
	for (uint i = 0u; i < 3u && entry == NONE; i++)
		entry = landed_entry(at + (i == 0u ? 0.0 : i == 1u ? LANDED_ROUNDING : -LANDED_ROUNDING) * normal, layer);
	if (entry == NONE)
		entry = landed_entry(at, 1u - layer);
	if (entry == NONE)
		return vec3(0.0);
	bool front = dot(direction, normal) < 0.0;
	vec3 radiance = vec3(0.0);
	if (VCT_REFLECTS)
		radiance = uintBitsToFloat(texelFetch(vct_albedo, int(entry)).xyz) *
			   texelFetch(vct_sent, int(2u * entry + (front ? 0u : 1u))).rgb * (1.0 / PI);
	if (VCT_EMITS && (front || landed_emits_back(entry)))
		radiance += uintBitsToFloat(texelFetch(vct_emission, int(entry)).xyz);
	return radiance;
}

#endif
