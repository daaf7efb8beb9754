// Exact area and centroid of a triangle inside a unit cell, without a list of corners. The triangle's outline is cut at the
// heights 0 and 1. It is then integrated over the unit square, with x clamped to 0…1 (Green's theorem). Every piece is a
// continuous function of the corners, so rounding moves the sums by no more than it moves the corners.
#ifndef VOXEL_CLIP_GLSL
#define VOXEL_CLIP_GLSL

// Integrals of 1, x and y over the part of the square to the left of the outline so far, and the outline's extent.
struct integral {
	float area;
	vec2 moment;
	float climb;       // Σ |Δy|, the scale of the rounding error
	vec2 low;
	vec2 high;
};

integral integral_begin()
{
	integral r;
	r.area = 0.0;
	r.moment = vec2(0.0);
	r.climb = 0.0;
	r.low = vec2(1.0);
	r.high = vec2(0.0);
	return r;
}

// Adds the piece of the outline from p to q.
void add_piece(inout integral r, vec2 p, vec2 q)
{
	vec2 y = clamp(vec2(p.y, q.y), 0.0, 1.0);
	float dy = y.y - y.x;
	float rise = q.y - p.y;
	float slope = abs(rise) > 1e-30 ? (q.x - p.x) / rise : 0.0;
	vec2 x = vec2(p.x, p.x) + (y - p.y) * slope;
	float dx = x.y - x.x;
	// The part of the piece where x is between 0 and 1, as a range of its length. Before and after it, x is clamped.
	vec2 s = dx != 0.0 ? clamp(vec2(-x.x, 1.0 - x.x) / dx, 0.0, 1.0) : vec2(0.0);
	float s0 = min(s.x, s.y);
	float s1 = max(s.x, s.y);
	float c0 = clamp(x.x, 0.0, 1.0);
	float c1 = clamp(x.y, 0.0, 1.0);
	float a = clamp(x.x + s0 * dx, 0.0, 1.0);
	float b = clamp(x.x + s1 * dx, 0.0, 1.0);
	float ya = y.x + s0 * dy;
	float yb = y.x + s1 * dy;
	float l = s1 - s0;
	r.area += dy * (s0 * c0 + l * 0.5 * (a + b) + (1.0 - s1) * c1);
	r.moment.x += dy * (s0 * 0.5 * c0 * c0 + l * (a * a + a * b + b * b) * (1.0 / 6.0) + (1.0 - s1) * 0.5 * c1 * c1);
	r.moment.y += dy * (s0 * c0 * 0.5 * (y.x + ya) + l * (2.0 * (ya * a + yb * b) + ya * b + yb * a) * (1.0 / 6.0) +
			    (1.0 - s1) * c1 * 0.5 * (yb + y.y));
	r.climb += abs(dy);
	r.low = min(r.low, min(p, q));
	r.high = max(r.high, max(p, q));
}

// The places where the outline leaves a height and where it comes back.
struct gap {
	vec2 from;
	vec2 to;
	bool open;
};

vec2 at_height(vec3 p, vec3 q, float h)
{
	return p.xy + (q.xy - p.xy) * clamp((h - p.z) / (q.z - p.z), 0.0, 1.0);
}

// Adds the part of the edge from p to q between the heights 0 and 1.
void add_edge(inout integral r, inout gap below, inout gap above, vec3 p, vec3 q)
{
	bool p0 = p.z < 0.0;
	bool q0 = q.z < 0.0;
	bool p1 = p.z > 1.0;
	bool q1 = q.z > 1.0;
	if ((p0 && q0) || (p1 && q1))
		return;
	vec2 from = p0 ? at_height(p, q, 0.0) : p1 ? at_height(p, q, 1.0) : p.xy;
	vec2 to = q0 ? at_height(p, q, 0.0) : q1 ? at_height(p, q, 1.0) : q.xy;
	add_piece(r, from, to);
	below.to = p0 ? from : below.to;
	below.from = q0 ? to : below.from;
	below.open = below.open || p0 || q0;
	above.to = p1 ? from : above.to;
	above.from = q1 ? to : above.from;
	above.open = above.open || p1 || q1;
}

// The integrals over the unit square of the part of the triangle between the heights (z) 0 and 1. Corners are relative to
// the cell's low corner. The area is that of the projection; its sign is that of the triangle's winding.
integral clip_triangle(vec3 a, vec3 b, vec3 c)
{
	integral r = integral_begin();
	gap below = gap(vec2(0.0), vec2(0.0), false);
	gap above = gap(vec2(0.0), vec2(0.0), false);
	add_edge(r, below, above, a, b);
	add_edge(r, below, above, b, c);
	add_edge(r, below, above, c, a);
	if (below.open)
		add_piece(r, below.from, below.to);
	if (above.open)
		add_piece(r, above.from, above.to);
	r.low = clamp(r.low, 0.0, 1.0);
	r.high = clamp(r.high, r.low, vec2(1.0));
	return r;
}

#endif
