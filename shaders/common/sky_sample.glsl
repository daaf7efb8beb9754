// The radiance of an equirectangular environment map, and choosing its directions. Radiance is interpolated bilinearly between
// the middles of the texels, across the seam too. The includer declares sky_texels[] (vec4: struct environment_texel) and
// sky_rows[] (struct environment_row), or defines what finds them; `job` names the map's size and turn.
#ifndef COMMON_SKY_SAMPLE_GLSL
#define COMMON_SKY_SAMPLE_GLSL

#include "common/sampling.glsl"
#include "common/sky_place.glsl"

#ifndef SKY_TEXEL
#define SKY_TEXEL(x, y) sky_texels[(y) * job.sky_width + (x)]
#define SKY_ROW(i) sky_rows[i]
#endif

struct sky_view {
	vec3 radiance;
	float pdf;   // density of the direction by the table, 1/sr
};

sky_view sky_at(vec3 w)
{
	vec2 place = sky_place(w, job.sky_turn) * vec2(job.sky_width, job.sky_height);
	vec2 from = floor(place - 0.5);
	vec2 part = place - 0.5 - from;
	uint last = job.sky_height - 1u;
	uint x0 = from.x < 0.0 ? job.sky_width - 1u : min(uint(from.x), job.sky_width - 1u);
	uint x1 = x0 + 1u < job.sky_width ? x0 + 1u : 0u;
	uint y0 = min(uint(max(from.y, 0.0)), last);
	uint y1 = min(uint(from.y + 1.0), last);
	vec4 a = SKY_TEXEL(x0, y0), b = SKY_TEXEL(x1, y0), c = SKY_TEXEL(x0, y1), d = SKY_TEXEL(x1, y1);
	vec4 above = part.x < 0.5 ? a : b, below = part.x < 0.5 ? c : d;
	vec3 radiance = mix(mix(a.rgb, b.rgb, part.x), mix(c.rgb, d.rgb, part.x), part.y);
	return sky_view(radiance * job.sky_scale, part.y < 0.5 ? above.w : below.w);
}

// Chooses a texel. The row takes 39 random bits, so that even among many texels none is chosen more often than its
// neighbour; the table's `keep` takes 24 other bits.
uint sky_pick(uvec2 pick)
{
	uint count = job.sky_width * job.sky_height;
	uint row, low, carry;
	umulExtended(pick.x, count, row, low);
	uaddCarry(low, ((pick.y & 127u) * count) >> 7, carry);
	row += carry;
	environment_row e = SKY_ROW(row);
	return float(pick.y >> 8) * UNIT_24 < e.keep ? row : e.alias;
}

// Samples a direction in a texel. Measured from the nearer pole, the squared sine of half the polar angle is uniform, and
// precise.
vec3 sky_direction(uint texel, vec2 u)
{
	uint column = texel % job.sky_width, row = texel / job.sky_width;
	bool below = 2u * row >= job.sky_height;
	float line = float(below ? job.sky_height - 1u - row : row);
	vec2 edge = sin(vec2(line, line + 1.0) * (0.5 * PI / float(job.sky_height)));
	edge *= edge;
	float s = mix(edge.x, edge.y, u.y);
	float across = 2.0 * sqrt(max(s * (1.0 - s), 0.0));
	float longitude = ((float(column) + u.x) / float(job.sky_width) - 0.5 - job.sky_turn) * (2.0 * PI);
	float height = 1.0 - 2.0 * s;
	return vec3(across * sin(longitude), below ? -height : height, -across * cos(longitude));
}

#endif
