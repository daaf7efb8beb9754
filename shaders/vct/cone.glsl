// Marching a cone through the directional pyramid.
//
// Coverage is additive. A cell's coverage along an axis is the share of its face that surfaces hide. In a medium of such
// cells, a ray of direction d crosses |d_i| · step / side faces of axis i in a step, so the coverage that it meets there is
//     Σ_i |d_i| · (step / side) · coverage_i.
// For a flat wall this sums to the wall's coverage, whatever the angle, the level and the places of the samples (the
// weights of a trilinear filter add up to one). Opacity is that sum, limited to 1. So surfaces within one cone's breadth
// are taken to be one surface, or several side by side, rather than many at random behind each other.
//
// The surface from which a cone starts is itself in the cells around the start, on every level that the cone reads. Its
// coverage there is known and is subtracted: above a plane alone in the world, a cone hits nothing.
#ifndef VCT_CONE_GLSL
#define VCT_CONE_GLSL

#include "vct/params.glsl"

// Variants; macros that the program defines. All but the defaults exist for comparison.
#ifndef VCT_OWN
#define VCT_OWN true            // subtract the starting plane
#define VCT_SUM true            // coverage is additive; else opacities multiply, weighted by the direction's squares
#define VCT_ISOTROPIC false     // one value a cell for all directions
#define VCT_AMBIENT false       // add an ambient term, dimmed where surfaces are near
#endif

// A cone may meet a wall while its footprint doubles. It then sees part of the wall on one level and part on the next, and
// these parts need not add up to 1: some 5 % of the wall's light would be lost, and as much would leak through from behind.
// So coverage counts more the more a cone has already met: with d opacity = (1 + CONE_CLOSED · opacity) d coverage, a cone
// is opaque at a coverage of 0.61, and small objects hardly change.
#define CONE_CLOSED 1.5

layout(binding = VCT_PYRAMID_UNIT) uniform sampler3D vct_pyramid;

// With VCT_AMBIENT: nearness of what the last cone met, Σ opacity / (1 + fall-off · distance).
float cone_nearness;

// The start of a cone, and the plane from which it starts.
struct cone_origin {
	vec3 position;   // in cells of the finest level
	vec3 normal;     // unit
	vec3 facing;     // |normal|; 0 where the plane is too steep to be recognised along the axis
	vec3 inverse;    // 1 / normal; 0 in the same cases
	vec3 spread;     // half breadth, in cells, of the plane's coverage along each axis
	vec3 steep;      // 0: perpendicular to the axis … 1: oblique
	float start;     // distance of the first sample, in cells
};

cone_origin cone_from(vec3 position, vec3 normal, float shift)
{
	cone_origin o;
	o.position = (position - vct_low_cell.xyz) / vct_low_cell.w;
	o.normal = normal;
	vec3 n = abs(normal);
	bvec3 told = greaterThan(n, vec3(0.05));
	o.facing = mix(vec3(0.0), n, told);
	o.inverse = mix(vec3(0.0), 1.0 / normal, told);
	vec3 slope = sqrt(max(1.0 - n * n, 0.0)) / max(n, vec3(0.05));
	o.spread = 1.0 + 0.5 * slope;
	o.steep = min(slope, vec3(1.0));
	o.start = vct_march.start * (1.0 + vct_march.dither * shift);
	return o;
}

// Coverage and coverage × radiance in one direction along an axis. `at` is in cells of `level`, whose numbers are `sides`.
vec4 read_way(float way, vec3 at, vec3 sides, float level)
{
	float x = clamp(at.x, 0.5, sides.x - 0.5) / sides.x;
	return textureLod(vct_pyramid, vec3((way + x) * (1.0 / 6.0), at.yz / sides.yz), level);
}

// One sample: radiance × coverage × weight (rgb) and coverage × weight (a). `along` is |direction|. `own` is the coverage
// of the starting plane; it is subtracted together with its light. `inside` says, by axis, how far the filter lies within
// the grid.
vec4 read_cell(vec3 way, vec3 along, vec3 own, vec3 inside, vec3 at, vec3 sides, float level)
{
	vec3 weight = VCT_SUM ? along : along * along;
	float within = inside.x * inside.y * inside.z;
	own *= inside.yzx * inside.zxy;
	if (VCT_ISOTROPIC) {
		vec4 c = textureLod(vct_pyramid, at / sides, level);
		float left = max(c.a * within - max(own.x, max(own.y, own.z)), 0.0);
		return vec4(c.rgb * (left / max(c.a, 1e-6)), left);
	}
	vec4 x = read_way(way.x, at, sides, level);
	vec4 y = read_way(way.y, at, sides, level);
	vec4 z = read_way(way.z, at, sides, level);
	vec3 cover = vec3(x.a, y.a, z.a);
	vec3 left = weight * max(cover * within - own, 0.0);
	vec3 part = left / max(cover, 1e-6);
	return vec4(part.x * x.rgb + part.y * y.rgb + part.z * z.rgb, left.x + left.y + left.z);
}

// The part of each axis' coverage at `at` that belongs to the starting plane, which lies `height` cells of this level
// below.
vec3 own_cover(cone_origin o, vec3 at, float height)
{
	vec3 plane = at - height * o.inverse;
	plane = mix(floor(plane) + 0.5, plane, o.steep);
	vec3 tent = max(1.0 - abs(at - plane) / o.spread, 0.0) / o.spread;
	return mix(vec3(0.0), tent, greaterThan(o.facing, vec3(0.0)));
}

// The distance at which the cone, its footprint included, has left the grid; in cells of the finest level.
float cone_end(cone_origin o, vec3 direction)
{
	vec3 margin = vec3(exp2(float(vct_sides_top.w)));
	vec3 inverse = 1.0 / (direction + mix(vec3(-1e-9), vec3(1e-9), greaterThanEqual(direction, vec3(0.0))));
	vec3 a = (-margin - o.position) * inverse;
	vec3 b = (vec3(vct_sides_top.xyz) + margin - o.position) * inverse;
	vec3 far = max(a, b);
	return min(min(far.x, min(far.y, far.z)), vct_march.reach / vct_low_cell.w);
}

// Marches a cone at most `far` cells. Returns coverage × radiance (scaled) and the share of the cone that surfaces hide.
// `tangent` is of its half aperture.
vec4 cone_march_to(cone_origin o, vec3 direction, float tangent, float far)
{
	vec3 way = vec3(0.0, 2.0, 4.0) + mix(vec3(0.0), vec3(1.0), lessThan(direction, vec3(0.0)));
	vec3 along = abs(direction);
	float end = min(cone_end(o, direction), far);
	float top = float(vct_sides_top.w);
	float rise = dot(direction, o.normal);
	vec4 sum = vec4(0.0);
	cone_nearness = 0.0;
	float t = o.start;
	while (t < end && sum.a < 0.998) {
		// The footprint is half the cone's breadth, because a trilinear filter reaches as far again.
		float foot = clamp(t * tangent, 1.0, exp2(top));
		float level = min(floor(log2(foot) + 0.5), top);
		float shrink = exp2(-level);
		vec3 sides = max(vec3(vct_sides_top.xyz) * shrink, vec3(1.0));
		vec3 at = (o.position + t * direction) * shrink;
		float step = vct_march.step * foot;
		// Nothing is beyond the edge; the texture's clamping would repeat its last cell.
		vec3 inside = clamp(at + 0.5, 0.0, 1.0) * clamp(sides - at + 0.5, 0.0, 1.0);
		vec3 own = VCT_OWN ? own_cover(o, at, t * rise * shrink) : vec3(0.0);
		vec4 met = read_cell(way, along, own, inside, at, sides, level);
		float rest = 1.0 - sum.a;
		float before = sum.a;
		if (VCT_SUM) {
			met *= (1.0 + CONE_CLOSED * before) * step * shrink;
			sum += met * (met.a > rest ? rest / met.a : 1.0);
		} else {
			sum += met * rest;
		}
		if (VCT_AMBIENT)
			cone_nearness += (sum.a - before) / (1.0 + vct_march.falloff * t * vct_low_cell.w);
		t += step;
	}
	return sum;
}

vec4 cone_march(cone_origin o, vec3 direction, float tangent)
{
	return cone_march_to(o, direction, tangent, uintBitsToFloat(0x7f800000u));
}

#ifdef VCT_SKY
#include "common/sky_map.glsl"
layout(binding = SKY_CONES_UNIT) uniform sampler2DArray vct_sky_cones;

// Mean radiance of the environment map over a cone, W/(m² sr).
vec3 cone_background(vec3 direction, float tangent)
{
	float turn = uintBitsToFloat(vct_cones_emission.z);
	float layer = clamp(log2(max(tangent, 1e-6) / SKY_TANGENT_LEAST), 0.0, float(SKY_CONES_LAYERS - 1));
	vec2 at = sky_place(direction, turn);
	vec3 narrow = textureLod(vct_sky_cones, vec3(at, floor(layer)), 0.0).rgb;
	vec3 wide = textureLod(vct_sky_cones, vec3(at, ceil(layer)), 0.0).rgb;
	vec3 mean = tangent < SKY_TANGENT_SHARP ? sky_seen(direction, turn) : mix(narrow, wide, fract(layer));
	return mean * uintBitsToFloat(vct_cones_emission.w);
}
#else
vec3 cone_background(vec3 direction, float tangent)
{
	return vct_background_scale.rgb;
}
#endif

// Radiance of a cone with the background behind it, W/(m² sr).
vec3 cone_radiance(cone_origin o, vec3 direction, float tangent)
{
	vec4 c = cone_march(o, direction, tangent);
	vec3 ambient = vec3(VCT_AMBIENT ? vct_march.ambient * max(1.0 - cone_nearness, 0.0) : 0.0);
	return c.rgb / vct_background_scale.w + max(1.0 - c.a, 0.0) * cone_background(direction, tangent) + ambient;
}

// Irradiance / π from the diffuse cones about `shading`, kept above the true surface.
vec3 cone_irradiance(cone_origin o, vec3 x, vec3 y, vec3 shading)
{
	vec3 sum = vec3(0.0);
	for (uint i = 0u; i < vct_cones(); i++) {
		vec4 c = vct_cone[i];
		vec3 d = c.x * x + c.y * y + c.z * shading;
		float above = dot(d, o.normal);
		d = above < 0.0 ? d - 2.0 * above * o.normal : d;
		sum += c.w * cone_radiance(o, d, vct_tangent[i].x);
	}
	return sum;
}

#endif
