// Irradiance from emissive triangles without shadows, in closed form.
#ifndef DIRECT_LAMPS_GLSL
#define DIRECT_LAMPS_GLSL

#include "common/light.glsl"

// The z component of cross(a, b), scaled so that its length is the angle between a and b instead of the sine. a and b need
// not be unit.
float arc_z(vec3 a, vec3 b)
{
	vec3 c = cross(a, b);
	float s = length(c);
	return s > 0.0 ? c.z * (atan(s, dot(a, b)) / s) : 0.0;
}

// π times the form factor of a triangle for a plane at the origin, which is irradiance / radiance (Lambert 1760): half the
// sum over the outline's edges of the arcs that they subtend. a, b and c are the corners in a frame whose z is the plane's
// normal. The part below the horizon is cut off. Positive if the corners go clockwise as seen from the origin.
float triangle_form(vec3 a, vec3 b, vec3 c)
{
	vec3 from = a;
	float sum = 0.0;
	// Where the outline passes below the horizon and where it comes back: the horizon closes the polygon between these
	// points.
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

// The same of a triangle whose area is so small, for its distance, that the arcs cancel: as one point, or, where it is long
// for its distance, as a line of points, each of which has the triangle's breadth there. `normal` is twice its area.
float thin_form(vec3 a, vec3 b, vec3 c, vec3 normal)
{
	vec3 middle = (a + b + c) * (1.0 / 3.0);
	// The longest side runs from b to c.
	vec3 sides = vec3(dot(c - b, c - b), dot(a - c, a - c), dot(b - a, b - a));
	mat3 turned = sides.x >= max(sides.y, sides.z) ? mat3(a, b, c) : sides.y >= sides.z ? mat3(b, c, a) : mat3(c, a, b);
	vec3 along = turned[2] - turned[1];
	float l2 = max(dot(along, along), 1e-30);
	float foot = clamp(dot(turned[0] - turned[1], along) / l2, 0.0, 1.0);
	vec3 nearest = turned[1] + clamp(-dot(turned[1], along) / l2, 0.0, 1.0) * along;
	float parts = clamp(ceil(8.0 * sqrt(l2 / max(dot(nearest, nearest), 1e-30))), 1.0, 64.0);
	float sum = 0.0;
	float whole = 0.0;
	for (float i = 0.5; i < parts; i++) {
		float at = i / parts;
		float breadth = min(at / max(foot, 1e-6), (1.0 - at) / max(1.0 - foot, 1e-6));
		vec3 p = parts > 1.0 ? turned[1] + at * along : middle;
		float d2 = dot(p, p);
		sum += breadth * max(p.z, 0.0) * 0.5 * abs(dot(normal, p)) / (d2 * d2);
		whole += breadth;
	}
	return sum / whole;
}

// Irradiance, W/m², at a point from one triangle, without shadows. x, y, n are a frame whose n is the receiver's normal.
vec3 triangle_irradiance(triangle tri, vec3 position, vec3 x, vec3 y, vec3 n)
{
	material m = materials[tri.material];
	corners k = corners_of(tri);
	float away = dot(k.normal, position - k.v0);
	// A triangle sends no light within its own plane. Rounding must not lift a point of the triangle above its face:
	// the lamp would then fill the whole hemisphere.
	vec3 reach = max(max(abs(position), abs(k.v0)), max(abs(k.v1), abs(k.v2)));
	float rounding = 4e-6 * max(reach.x, max(reach.y, reach.z));
	if (!(away > rounding || ((m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u && away < -rounding)))
		return vec3(0.0);
	mat3 into = transpose(mat3(x, y, n));
	vec3 a = into * (k.v0 - position);
	vec3 b = into * (k.v1 - position);
	vec3 c = into * (k.v2 - position);
	// The coordinates are scaled to a size near 1: otherwise a cross product might leave the range of a float.
	vec3 most = max(abs(a), max(abs(b), abs(c)));
	float scale = 1.0 / max(most.x, max(most.y, most.z));
	a *= scale;
	b *= scale;
	c *= scale;
	vec3 normal = cross(b - a, c - a);
	vec3 middle = (a + b + c) * (1.0 / 3.0);
	float d2 = dot(middle, middle);
	float form;
	// Its area is taken before it was turned, because that rounds away what is thin.
	if (length(normal) < 1e-4 * d2)
		form = thin_form(a, b, c, into * cross(scale * (k.v1 - k.v0), scale * (k.v2 - k.v0)));
	else
		form = abs(triangle_form(a, b, c));
	return to_vec3(m.emission) * form;
}

// Irradiance, W/m², from all emissive triangles as if they had no textures. Only used when they are few.
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
