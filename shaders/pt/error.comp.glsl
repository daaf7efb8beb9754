// The error of the picture so far: of each tile the sums of server/worker/technique/pt/pt_relmse.h, whose header says
// what they estimate and why, from the two independent halves of each pixel's samples.
//
// A pixel's lesser and greater half, its mean and d, half their difference, are apart for each channel, and so is what
// stands for the true value r:
//   known    d is below a quarter of the mean: the mean, between the halves;
//   edge     the greater half is OUTLIER times the surroundings, and a neighbour's lesser half is as bright: the mean, within
//            WITHIN times. A lamp's rim is in some samples and not in others;
//   both     both halves are above the surroundings twice: their geometric mean, within WITHIN times. It is something small
//            and bright, the same in both;
//   else     the surroundings, within a factor of 2; where the lesser half is more, the geometric mean with that.
// The surroundings are the mean of the tile's other pixels without the brightest of them, which may be a firefly too. A term's
// lower end is by r = the greater half, which it is if the light found is no luck at all.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/tile.glsl"
#include "common/accumulate.glsl"
#include "shared/pt.h"
#include "shared/scene_params.h"

layout(local_size_x = TILE_PIXELS) in;

layout(push_constant) uniform Push {
	error_push push;
};
layout(std430, set = 0, binding = BIND_JOB) readonly buffer Job {
	scene_params job;
};
layout(std430, set = 0, binding = BIND_ERROR_FILM) readonly buffer Film {
	film_pixel film[];
};
layout(std430, set = 0, binding = BIND_ERRORS) writeonly buffer Errors {
	error_tile errors[];
};

#define AROUND (TILE_SIDE + 2) // the tile and a pixel on each side
#define OUTLIER 4.0 // times the surroundings
#define TWICE 2.0
#define WITHIN 4.0
#define TERM_MOST 1e15 // of a term: its square must be a number

// The halves of the pixels around; -1: not of the picture.
shared vec3 lesser[AROUND * AROUND];
shared vec3 greater[AROUND * AROUND];
shared vec4 parts[TILE_PIXELS];
shared vec2 more_parts[TILE_PIXELS];
shared uint outliers; // some pixel of the tile is one, so its neighbours matter

vec3 half_sum(uint first)
{
	return vec3(sums[first].x + sums[first].y, sums[first + 1u].x + sums[first + 1u].y, sums[first + 2u].x + sums[first + 2u].y);
}

// The mean of what light paths contributed to a pixel, W/(m² sr); `unit` is the radiance of one unit of the film.
vec3 film_mean(uint pixel, uint first, float unit)
{
	vec3 sum;
	for (uint i = 0u; i < 3u; i++) {
		uint part = 2u * (first + i);
		sum[i] = float(film[pixel].parts[part + 1u]) * 4294967296.0 + float(film[pixel].parts[part]);
	}
	return sum * unit;
}

// Put the halves of place `i` around the tile into `lesser` and `greater`.
void load(uvec2 corner, uint i)
{
	ivec2 pixel = ivec2(corner) + ivec2(i % AROUND, i / AROUND) - 1;
	int row = pixel.y - int(push.first_row);
	lesser[i] = vec3(-1.0);
	greater[i] = vec3(-1.0);
	if (pixel.x < 0 || pixel.x >= int(job.width) || row < 0 || row >= int(push.rows))
		return;
	bool more = uint(pixel.y) / TILE_SIDE * job.tiles_x + uint(pixel.x) / TILE_SIDE < push.more_tiles;
	uint at = uint(row) * job.width + uint(pixel.x);
	sums_load(at);
	vec3 a = half_sum(0u) / (more ? push.more_a : push.count_a);
	vec3 b = half_sum(3u) / (more ? push.more_b : push.count_b);
	if (push.has_film != 0u) {
		a += film_mean(at, 0u, push.film_a);
		b += film_mean(at, 3u, push.film_b);
	}
	lesser[i] = min(a, b);
	greater[i] = max(a, b);
}

vec3 mean_at(uint i)
{
	return 0.5 * lesser[i] + 0.5 * greater[i];
}

bvec3 known_at(uint i)
{
	return lessThanEqual(2.0 * (greater[i] - lesser[i]), mean_at(i));
}

bvec3 all_of(bvec3 a, bvec3 b)
{
	return bvec3(a.x && b.x, a.y && b.y, a.z && b.z);
}

uint inside(uint lane)
{
	return (lane / TILE_SIDE + 1u) * AROUND + lane % TILE_SIDE + 1u;
}

// Of some pixels of the tile: the brightest, the second, the sum of all but the brightest, which no subtraction rounds, and
// their number.
struct level {
	vec3 brightest, second, rest;
	float count;
};
shared level rows[TILE_SIDE];
shared level whole;

level join(level a, level b)
{
	vec3 less = min(a.brightest, b.brightest);
	return level(max(a.brightest, b.brightest), max(less, max(a.second, b.second)), a.rest + b.rest + less, a.count + b.count);
}

// Fill in `whole`. All lanes call it, and may read it after their next barrier.
void level_tile(uint lane)
{
	const level none = level(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
	level all = none;
	uint pixels = lane < TILE_SIDE ? TILE_SIDE : 0u;
	for (uint x = 0u; x < pixels; x++) {
		vec3 here = mean_at(inside(lane * TILE_SIDE + x));
		all = join(all, level(max(here, vec3(0.0)), vec3(0.0), vec3(0.0), here.x < 0.0 ? 0.0 : 1.0));
	}
	if (lane < TILE_SIDE)
		rows[lane] = all;
	barrier();
	all = none;
	uint sides = lane == 0u ? TILE_SIDE : 0u;
	for (uint y = 0u; y < sides; y++)
		all = join(all, rows[y]);
	if (lane == 0u)
		whole = all;
}

// The mean of the tile's pixels but this one and the brightest of the others.
vec3 surroundings(vec3 mean)
{
	vec3 others = mix(whole.rest - mean, whole.rest - whole.second, greaterThanEqual(mean, whole.brightest));
	return max(others, vec3(0.0)) / max(whole.count - 2.0, 1.0);
}

bvec3 is_outlier(vec3 high, vec3 around)
{
	return greaterThan(high, OUTLIER * around);
}

// Whether the lesser half of one of the eight neighbours is as bright.
bvec3 beside_bright(uint i, vec3 mean, vec3 most)
{
	vec3 found = vec3(0.0);
	uint places = outliers != 0u ? 9u : 0u;
	for (uint place = 0u; place < places; place++) {
		vec3 other = lesser[i + place / 3u * AROUND + place % 3u - AROUND - 1u];
		bvec3 alike = all_of(greaterThanEqual(other, mean), lessThanEqual(other, WITHIN * most));
		found = max(found, place == 4u ? vec3(0.0) : vec3(alike));
	}
	return greaterThan(found, vec3(0.0));
}

// d² / (r² + 0.01) over the channels, for numbers whose squares may overflow.
float term(vec3 d, vec3 r)
{
	vec3 unit = max(max(abs(d), abs(r)), vec3(1.0));
	vec3 x = d / unit, y = r / unit;
	vec3 relative = x * x / (y * y + 0.01 / unit / unit);
	return min(relative.r + relative.g + relative.b, TERM_MOST);
}

// The sums of the lane's pixel.
void measure(uint lane, out vec4 first, out vec2 second)
{
	uint i = inside(lane);
	vec3 low = lesser[i], high = greater[i], mean = mean_at(i), d = 0.5 * (high - low);
	// What is around may be a lamp of which this pixel is the rim: it is not brighter than its own greater half.
	vec3 around = min(surroundings(mean), high);
	vec3 likely = sqrt(max(low, around)) * sqrt(around), middle = sqrt(max(low, vec3(0.0))) * sqrt(high);
	bvec3 known = known_at(i);
	bvec3 edge = all_of(is_outlier(high, around), beside_bright(i, mean, high));
	bvec3 both = greaterThan(low, TWICE * around);
	vec3 r = mix(mix(mix(likely, middle, both), mean, edge), mean, known);
	vec3 r_low = mix(mix(mix(0.5 * likely, middle / WITHIN, both), mean / WITHIN, edge), low, known);
	bvec3 found = bvec3(known.x || edge.x || both.x, known.y || edge.y || both.y, known.z || edge.z || both.z);
	vec3 lucky = mix(max(mean - around, vec3(0.0)), vec3(0.0), found);
	float t = term(d, r), below = t - term(d, high), above = term(d, r_low) - t;
	float apart = t - term(mix(mean - r, vec3(0.0), found), r);
	first = vec4(t, min(4.0 / 3.0 * t * t, 1.5 * apart * apart), below * below, above * above);
	second = vec2(lucky.r + lucky.g + lucky.b, mean.r + mean.g + mean.b);
}

void main()
{
	uint lane = gl_LocalInvocationIndex;
	uint tile = push.first_tile + gl_WorkGroupID.x;
	uvec2 corner = uvec2(tile % job.tiles_x, tile / job.tiles_x) * TILE_SIDE;
	uint mid = inside(lane);
	load(corner, mid);
	outliers = 0u;
	barrier();
	level_tile(lane);
	barrier();
	bool mine = lesser[mid].x >= 0.0;
	if (mine && any(all_of(not(known_at(mid)), is_outlier(greater[mid], surroundings(mean_at(mid))))))
		atomicOr(outliers, 1u);
	barrier();
	uint places = outliers != 0u ? AROUND * AROUND : 0u;
	for (uint i = lane; i < places; i += TILE_PIXELS)
		if (i % AROUND % (AROUND - 1) == 0u || i / AROUND % (AROUND - 1) == 0u)
			load(corner, i);
	barrier();
	vec4 first = vec4(0.0);
	vec2 second = vec2(0.0);
	if (mine)
		measure(lane, first, second);
	parts[lane] = first;
	more_parts[lane] = second;
	barrier();
	for (uint reach = TILE_SIDE; reach > 0u; reach /= TILE_SIDE) {
		first = vec4(0.0);
		second = vec2(0.0);
		uint each = lane < reach ? TILE_SIDE : 0u;
		for (uint i = 0u; i < each; i++) {
			first += parts[lane + i * reach];
			second += more_parts[lane + i * reach];
		}
		barrier();
		if (lane < reach) {
			parts[lane] = first;
			more_parts[lane] = second;
		}
		barrier();
	}
	if (lane == 0u)
		errors[tile] = error_tile(parts[0].x, parts[0].y, parts[0].z, parts[0].w, more_parts[0].x, more_parts[0].y);
}
