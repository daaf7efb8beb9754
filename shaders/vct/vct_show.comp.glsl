// Displays the voxels themselves: for each pixel the first occupied cell along its ray, or a slice of the grid seen
// straight on. Each cell is shown with its one value, without filtering. Level 0 is the voxels; level n is level n − 1 of
// the pyramid.
#version 450 core
#extension GL_GOOGLE_include_directive : require
#define SCENE_WITHOUT_TRACE
#define SCENE_WITHOUT_LAMPS
#define SCENE_WITHOUT_TANGENTS
#define SCENE_WITHOUT_GGX

#include "common/camera.glsl"
#include "deferred/radiance.glsl"
#include "shared/vct_show.h"
#include "vct/params.glsl"
#include "voxel/lookup.glsl"

#ifndef VCT_SHOW
#define VCT_SHOW VCT_SHOW_RADIANCE
#define VCT_SHOW_PYRAMID false
#endif
#ifndef VCT_ISOTROPIC
#define VCT_ISOTROPIC false
#endif

layout(local_size_x = TILE_PIXELS) in;
layout(location = VCT_SHOW_WHERE) uniform uvec4 where;
layout(location = VCT_SHOW_CORNER) uniform uvec2 corner;
layout(binding = VCT_PYRAMID_UNIT) uniform sampler3D vct_pyramid;
layout(std430, binding = BIND_VCT_TOTAL) readonly buffer VctTotal {
	float vct_total[];
};

uvec3 level_sides()
{
	return voxel_sides() >> where.x;
}

// The value of an entry's front or back.
vec3 entry_value(uint entry, bool front)
{
	if (VCT_SHOW == VCT_SHOW_ALBEDO)
		return voxel_diffuse_albedo(entry);
	if (VCT_SHOW == VCT_SHOW_NORMAL)
		return 0.5 + 0.5 * voxel_normal(entry);
	if (VCT_SHOW == VCT_SHOW_EMISSION)
		return front ? voxel_emitted(entry) : vec3(0.0);
	uint i = entry * VCT_ENTRY_FLOATS + (front ? 0u : VCT_SIDE_FLOATS);
	vec3 irradiance = vec3(vct_total[i], vct_total[i + 1u], vct_total[i + 2u]);
	if (VCT_SHOW == VCT_SHOW_IRRADIANCE)
		return irradiance;
	bool shines = front && vct_cones_emission.y != 0u;
	return voxel_diffuse_albedo(entry) * irradiance * (1.0 / PI) + (shines ? voxel_emitted(entry) : vec3(0.0));
}

// The value of a voxel. Fronts hide backs, because a voxel of a thin wall also contains the wall's other side.
vec3 voxel_value(uvec3 voxel, vec3 direction)
{
	uint layers = voxel_layers(voxel);
	vec4 front = vec4(0.0);
	vec4 back = vec4(0.0);
	vec3 cover = vec3(0.0);
	for (uint layer = 0u; layer < 2u; layer++) {
		if ((layers >> layer & 1u) == 0u)
			continue;
		uint entry = voxel_entry(voxel, layer);
		if (VCT_SHOW == VCT_SHOW_COVERAGE) {
			vec3 plus;
			vec3 minus;
			voxel_projections(entry, plus, minus);
			cover += plus + minus;
			continue;
		}
		float area = max(voxel_area(entry), 1e-20);
		if (dot(voxel_normal(entry), direction) <= 0.0)
			front += area * vec4(entry_value(entry, true), 1.0);
		else
			back += area * vec4(entry_value(entry, false), 1.0);
	}
	if (VCT_SHOW == VCT_SHOW_COVERAGE)
		return min(cover, vec3(1.0));
	vec4 sum = front.a > 0.0 ? front : back;
	return sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
}

// The value of a cell of the pyramid seen along `direction`, or in all directions if that is zero. rgb: coverage ×
// radiance; a: coverage.
vec4 pyramid_sum(uvec3 cell, vec3 direction, out vec3 cover)
{
	uint wide = level_sides().x;
	if (VCT_ISOTROPIC) {
		vec4 c = texelFetch(vct_pyramid, ivec3(cell), int(where.x) - 1);
		cover = vec3(c.a);
		return c;
	}
	bool every = direction == vec3(0.0);
	vec4 sum = vec4(0.0);
	cover = vec3(0.0);
	for (uint axis = 0u; axis < 3u; axis++) {
		for (uint way = 0u; way < 2u; way++) {
			float along = way == 0u ? direction[axis] : -direction[axis];
			vec4 c = texelFetch(vct_pyramid, ivec3(cell.x + (2u * axis + way) * wide, cell.yz), int(where.x) - 1);
			c *= every || along > 0.0 ? 1.0 : 0.0;
			cover[axis] = max(cover[axis], c.a);
			sum += c * (every ? 1.0 : abs(along));
		}
	}
	return sum;
}

bool occupied(uvec3 cell, vec3 direction)
{
	vec3 cover;
	if (VCT_SHOW_PYRAMID)
		return pyramid_sum(cell, direction, cover).a > 0.0;
	return voxel_layers(cell) != 0u;
}

vec3 cell_value(uvec3 cell, vec3 direction)
{
	if (!VCT_SHOW_PYRAMID)
		return voxel_value(cell, direction);
	vec3 cover;
	vec4 sum = pyramid_sum(cell, direction, cover);
	if (VCT_SHOW == VCT_SHOW_COVERAGE)
		return cover;
	return sum.rgb / (sum.a * vct_background_scale.w);
}

// Finds the first occupied cell that the ray through a pixel enters, by stepping from plane to plane between cells
// (Amanatides and Woo 1987, "A fast voxel traversal algorithm for ray tracing"). The cell that contains the eye is
// transparent.
bool first_cell(uvec2 pixel, out uvec3 found, out vec3 direction)
{
	vec3 origin;
	camera_ray(vec2(pixel) + jitter, origin, direction);
	ivec3 sides = ivec3(level_sides());
	vec3 o = voxel_from_metres(origin) * exp2(-float(where.x));
	vec3 d = mix(direction, mix(vec3(-1e-9), vec3(1e-9), greaterThanEqual(direction, vec3(0.0))),
		lessThan(abs(direction), vec3(1e-9)));
	vec3 inverse = 1.0 / d;
	vec3 a = -o * inverse;
	vec3 b = (vec3(sides) - o) * inverse;
	vec3 low = min(a, b);
	vec3 high = max(a, b);
	float near = max(low.x, max(low.y, low.z));
	float far = min(high.x, min(high.y, high.z));
	ivec3 turn_up = ivec3(greaterThan(d, vec3(0.0)));
	// Far beside the grid a place may be beyond what an int can take.
	ivec3 cell = ivec3(clamp(floor(o + max(near, 0.0) * d), vec3(0.0), vec3(sides - 1)));
	bool look = near > 0.0;
	bool inside = far > max(near, 0.0);
	bool met = false;
	found = uvec3(0u);
	// No ray crosses more cells than this.
	for (int i = sides.x + sides.y + sides.z; i > 0 && inside && !met; i--) {
		met = look && occupied(uvec3(cell), direction);
		found = uvec3(cell);
		look = true;
		vec3 leave = (vec3(cell + turn_up) - o) * inverse;
		bvec3 axis = bvec3(leave.x <= min(leave.y, leave.z), leave.y < leave.x && leave.y <= leave.z,
			leave.z < min(leave.x, leave.y));
		cell += ivec3(axis) * (2 * turn_up - 1);
		inside = all(greaterThanEqual(cell, ivec3(0))) && all(lessThan(cell, sides));
	}
	return met;
}

// The cell of a slice at a pixel. Slices across x are seen from +x with −z to the right, slices across y from above with x
// to the right and −z up, slices across z from +z with x to the right: the viewer always looks against the axis.
bool slice_cell(uvec2 pixel, out uvec3 cell)
{
	uvec3 sides = level_sides();
	uvec2 across = where.y == 0u ? sides.zy : where.y == 1u ? sides.xz : sides.xy;
	uvec2 at = (pixel - corner) / where.w;
	if (any(lessThan(pixel, corner)) || any(greaterThanEqual(at, across)))
		return false;
	uint up = across.y - 1u - at.y;
	cell = where.y == 0u ? uvec3(where.z, up, across.x - 1u - at.x)
	     : where.y == 1u ? uvec3(at.x, where.z, at.y)
	                     : uvec3(at.x, up, where.z);
	return occupied(cell, vec3(0.0));
}

void main()
{
	uvec2 pixel;
	if (!pixel_mine(pixel))
		return;
	uvec3 cell;
	vec3 direction = vec3(0.0);
	bool met = where.z != NONE ? slice_cell(pixel, cell) : first_cell(pixel, cell, direction);
	if (met)
		pixel_add(pixel, cell_value(cell, direction));
	else if (VCT_SHOW == VCT_SHOW_RADIANCE && where.z == NONE && EFFECT_ENVIRONMENT)
		pixel_add(pixel, to_vec3(job.background));
}
