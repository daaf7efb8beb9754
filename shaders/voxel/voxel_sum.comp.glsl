// Sums over every triangle's part in every cell: areas, colours and places, each weighted by area. Sums are in fixed point,
// so that they do not depend on the order of additions. Values are rounded up or down by a number derived from the
// triangle's place, so that the rounding is unbiased. Only the area is never rounded to zero.
#version 450 core
#extension GL_GOOGLE_include_directive : require

#include "voxel/clip.glsl"
#include "voxel/sample.glsl"

layout(local_size_x = VOXEL_GROUP) in;

SCENE_BUFFER(BIND_VOXEL_WORDS) buffer VoxelWords {
	uvec2 voxel_words[];
};
// Four words for each entry: area and place; albedo and projection +x; emission and projection −x; projections +y −y +z −z.
SCENE_BUFFER(BIND_VOXEL_PLACE) buffer PlaceSums {
	uint place_sums[];
};
SCENE_BUFFER(BIND_VOXEL_ALBEDO) buffer AlbedoSums {
	uint albedo_sums[];
};
SCENE_BUFFER(BIND_VOXEL_EMISSION) buffer EmissionSums {
	uint emission_sums[];
};
SCENE_BUFFER(BIND_VOXEL_COVERAGE) buffer CoverageSums {
	uint coverage_sums[];
};

// x: units of area in a voxel side's square; y: the same for area × the scene's brightest emission.
layout(location = 1) uniform vec2 units;
// Number of words of the grid; the word behind them holds the VOXEL_FULL_… flags.
layout(location = 2) uniform uint words;

// The part of a triangle that is in a cell.
struct part {
	float share;       // share of the triangle's area
	vec3 middle;     // from the cell's low corner, in rotated axes
	vec2 low;
	vec2 high;
};

bool is_within_one_cell(tile t)
{
	return all(equal(ivec3(floor(t.low)), last_cell(t.low, t.high)));
}

// Share of a triangle's area up to a place along its longest edge, 0 … 1; `foot` is the foot of its height on that edge.
float share_until(float at, float foot)
{
	return at < foot ? at * at / foot : 1.0 - (1.0 - at) * (1.0 - at) / max(1.0 - foot, 1e-20);
}

// For triangles too thin to have a centroid: the middle of the part of the longest edge that is within the cell (xyz), and
// the share of the triangle's area along that part (w).
vec4 edge_within(tile t, vec3 a)
{
	bool first = dot(t.e1, t.e1) > dot(t.e2, t.e2);
	vec3 d = first ? t.e1 : t.e2;
	bool third = dot(t.e3, t.e3) > dot(d, d);
	vec3 from = third ? a + t.e1 : a;
	d = third ? t.e3 : d;
	vec3 other = (third ? a : first ? a + t.e2 : a + t.e1) - from;
	float foot = clamp(dot(other, d) / max(dot(d, d), 1e-30), 0.0, 1.0);
	vec3 inverse = 1.0 / mix(d, vec3(1e-20), lessThan(abs(d), vec3(1e-20)));
	vec3 t0 = -from * inverse;
	vec3 t1 = (1.0 - from) * inverse;
	vec3 near = min(t0, t1);
	vec3 far = max(t0, t1);
	float enter = clamp(max(near.x, max(near.y, near.z)), 0.0, 1.0);
	float leave = clamp(min(far.x, min(far.y, far.z)), 0.0, 1.0);
	return vec4(from + 0.5 * (enter + leave) * d, max(share_until(leave, foot) - share_until(enter, foot), 0.0));
}

part part_of(tile t, ivec3 cell)
{
	part p;
	vec3 a = t.start - vec3(cell);
	integral i = clip_triangle(a, a + t.e1, a + t.e2);
	float whole = 0.5 * abs(t.normal.z);
	bool one = is_within_one_cell(t);
	vec4 edge = edge_within(t, a);
	float inside = clamp(t.normal.z < 0.0 ? -i.area : i.area, 0.0, whole);
	p.share = one ? 1.0 : t.needle || whole <= 0.0 ? edge.w : inside / whole;
	p.low = i.low;
	p.high = i.high;
	if (one) {
		p.middle = a + (t.e1 + t.e2) * (1.0 / 3.0);
	} else if (inside > 1e-5 * i.climb && !t.needle) {
		p.middle.xy = i.moment / i.area;
		p.middle.z = a.z + dot(t.slope, p.middle.xy - a.xy);
	} else {
		p.middle = edge.xyz;
	}
	p.middle = clamp(p.middle, 0.0, 1.0);
	return p;
}

void add_area(uint entry, uint v)
{
	uint before = atomicAdd(place_sums[4u * entry], v);
	bool full = before + v < before;
	while (full) {
		atomicOr(voxel_words[words].x, VOXEL_FULL_AREA);
		full = false;
	}
}

void add_emission(uint entry, vec3 emission, bool both_sides, float scale, float round_up)
{
	bool emits = any(greaterThan(emission, vec3(0.0)));
	// A loop instead of an `if`, because some drivers execute the body of an `if` in any case.
	while (emits) {
		uvec3 v = uvec3(emission * scale + round_up);
		bool full = false;
		for (uint c = 0u; c < 3u; c++) {
			uint b = atomicAdd(emission_sums[4u * entry + c], v[c]);
			full = full || b + v[c] < b;
		}
		if (full)
			atomicOr(voxel_words[words].x, VOXEL_FULL_EMISSION);
		atomicOr(emission_sums[4u * grid_sides_entries.w + (entry >> 5)], both_sides ? 1u << (entry & 31u) : 0u);
		emits = false;
	}
}

// Adds a part's projections on the axes, separately for each sign.
void add_projections(uint entry, vec3 projected, float round_up)
{
	uvec3 v = uvec3(abs(projected) * units.x + round_up);
	if (projected.x < 0.0)
		atomicAdd(emission_sums[4u * entry + 3u], v.x);
	else
		atomicAdd(albedo_sums[4u * entry + 3u], v.x);
	atomicAdd(coverage_sums[4u * entry + (projected.y < 0.0 ? 1u : 0u)], v.y);
	atomicAdd(coverage_sums[4u * entry + (projected.z < 0.0 ? 3u : 2u)], v.z);
}

void add_part(tile t, ivec3 cell, uint entry)
{
	part p = part_of(t, cell);
	float r = dither(t, cell);
	look l = look_at(t, cell, p.low, p.high, p.middle.xy, r);
	vec3 projected = t.normal * (0.5 * p.share * l.there);
	float area = length(projected);
	uint weight = uint(area * units.x + r);
	weight = l.there > 0.0 ? max(weight, 1u) : weight;
	add_area(entry, weight);
	float w = float(weight);
	vec3 place = min(turn_back(p.middle, t.k), 1.0) * w;
	vec3 albedo = l.albedo * w;
	for (uint c = 0u; c < 3u; c++) {
		atomicAdd(place_sums[4u * entry + 1u + c], uint(min(place[c] + r, w)));
		atomicAdd(albedo_sums[4u * entry + c], uint(min(albedo[c] + r, w)));
	}
	if (EFFECT_EMITTERS)
		add_emission(entry, l.emission,
			     (materials[triangles[t.id].material].flags & MATERIAL_EMITS_BOTH_SIDES) != 0u, w * (units.y / units.x), r);
	add_projections(entry, turn_back(projected, t.k), r);
}

void main()
{
	if (gl_GlobalInvocationID.x >= item_range.y)
		return;
	tile t = tile_of(items[item_range.x + gl_GlobalInvocationID.x]);
	uint layer = layer_of(t);
	walk w = walk_begin(t);
	ivec3 cell;
	while (walk_next(t, w, cell)) {
		uint bit = bit_of(t, cell, layer);
		uvec2 word = bit != NONE ? voxel_words[bit >> 5] : uvec2(0u);
		uint at = 1u << (bit & 31u);
		if ((word.x & at) != 0u)
			add_part(t, cell, word.y + uint(bitCount(word.x & at - 1u)));
	}
}
