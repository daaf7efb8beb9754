// Emissive triangles without shadows: the irradiance of a plane in closed form.
#ifndef DIRECT_LAMPS_GLSL
#define DIRECT_LAMPS_GLSL

#include "common/light.glsl"

// The angle between two directions as an arc: cross(a, b) · z, scaled from the sine to the angle. a and b need not be unit.
float arc_z(vec3 a, vec3 b)
{
	vec3 c = cross(a, b);
	float s = length(c);
	return s > 0.0 ? c.z * (atan(s, dot(a, b)) / s) : 0.0;
}

// The vector irradiance's z component over radiance: Lambert 1760; Σ of arcs over a polygon's edges, halved. a, b and c are a
// triangle's corners in a frame whose z is the plane's normal; what is below the horizon is cut off. Positive if the corners
// go round clockwise as seen from the origin.
float triangle_form(vec3 a, vec3 b, vec3 c)
{
	vec3 from = a;
	float sum = 0.0;
	// Where the outline goes below the horizon, and where it comes back: the horizon closes the polygon between them.
	vec3 leave = vec3(0.0);
	vec3 enter = vec3(0.0);
	for (uint i = 0u; i < 3u; i++) {
		vec3 to = i == 0u ? b : i == 1u ? c : a;
		vec3 cut = vec3((from.xy * to.z - to.xy * from.z) / (to.z - from.z), 0.0);
		bool up = from.z > 0.0;
		bool crosses = up != (to.z > 0.0);
		if (crosses && up)
			leave = cut;
		if (crosses && !up)
			enter = cut;
		if (up || crosses)
			sum += arc_z(crosses && !up ? cut : from, crosses && up ? cut : to);
		from = to;
	}
	return 0.5 * (sum + arc_z(leave, enter));
}

// Irradiance at a point from one triangle, without shadows. x, y, n: a frame, n the receiver's normal.
vec3 triangle_irradiance(triangle tri, vec3 position, vec3 x, vec3 y, vec3 n)
{
	material m = materials[tri.material];
	corners k = corners_of(tri);
	float away = dot(k.normal, position - k.v0);
	// In its own plane nothing comes from a triangle. Rounding must not lift a point of it over its face: all of the hemisphere
	// would be lamp.
	vec3 reach = max(max(abs(position), abs(k.v0)), max(abs(k.v1), abs(k.v2)));
	float rounding = 4e-6 * max(reach.x, max(reach.y, reach.z));
	if (!(away > rounding || ((m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u && away < -rounding)))
		return vec3(0.0);
	mat3 into = transpose(mat3(x, y, n));
	vec3 a = into * (k.v0 - position);
	vec3 b = into * (k.v1 - position);
	vec3 c = into * (k.v2 - position);
	// Scaled to a size near 1: a cross product of coordinates as they are need not fit a float.
	vec3 most = max(abs(a), max(abs(b), abs(c)));
	float scale = 1.0 / max(most.x, max(most.y, most.z));
	a *= scale;
	b *= scale;
	c *= scale;
	vec3 normal = cross(b - a, c - a);
	vec3 middle = (a + b + c) * (1.0 / 3.0);
	float d2 = dot(middle, middle);
	float form;
	// The arcs of a small triangle far away cancel; it is a point then, to one part in 10⁴.
	if (length(normal) < 1e-4 * d2)
		form = max(middle.z, 0.0) * 0.5 * abs(dot(normal, middle)) / (d2 * d2);
	else
		form = abs(triangle_form(a, b, c));
	return to_vec3(m.emission) * form;
}

// From all emissive triangles: there are few, and their radiance is the same all over.
vec3 lamps_irradiance(vec3 position, vec3 n)
{
	vec3 x, y;
	frame_make(n, x, y);
	vec3 sum = vec3(0.0);
	for (uint i = 0u; i < job.emitter_count; i++)
		sum += triangle_irradiance(triangles[emitters[i].triangle], position, x, y, n);
	return sum;
}

#endif
