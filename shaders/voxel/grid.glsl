// The voxel grid, and the cells that a triangle overlaps. The test uses the separating axes of a triangle and a box
// (Akenine-Möller 2001, "Fast 3D triangle-box overlap testing"), over the columns of a struct voxel_item.
//
// Coordinates are in voxels relative to the triangle's first corner, so that the shape of a small triangle stays exact
// wherever it lies. A cell counts as overlapped if it is within VOXEL_SLACK of the triangle. Rounding stays below that, so
// nothing thin is lost.
#ifndef VOXEL_GRID_GLSL
#define VOXEL_GRID_GLSL

#define SCENE_WITHOUT_TRACE
#define SCENE_WITHOUT_LAMPS
#define SCENE_WITHOUT_TANGENTS
#define SCENE_WITHOUT_GGX
#include "common/surface.glsl"
#include "shared/voxel.h"
#include "voxel/grid_block.glsl"

SCENE_BUFFER(BIND_VOXEL_ITEMS) readonly buffer VoxelItems {
	voxel_item items[];
};

// The items of this dispatch: first, count.
layout(location = 0) uniform uvec2 item_range;

const float VOXEL_SLACK = 1.0 / 4096.0;

// Rotates the axes so that axis `k` becomes z; turn_back undoes it. Cyclic, so that handedness is kept.
vec3 turn_axes(vec3 v, uint k)
{
	return k == 0u ? v.yzx : k == 1u ? v.zxy : v;
}

vec3 turn_back(vec3 v, uint k)
{
	return k == 0u ? v.zxy : k == 1u ? v.yzx : v;
}

// A triangle over the grid, with rotated axes: columns run along z.
struct tile {
	uint id;           // of the triangle
	uint k;            // the axis that became z
	bool needle;
	vec3 start;        // first corner, in voxels
	vec3 e1;           // edges from it to the other corners
	vec3 e2;
	vec3 e3;           // edge from the second corner to the third
	vec3 normal;       // e1 × e2
	vec3 low;          // bounding box
	vec3 high;
	vec2 slope;        // change of its height per column
	ivec2 first;       // columns
	ivec2 size;
	ivec2 range;       // cells along z that the bounding box touches
	// Separating axes: the edges × x, × y, × z, three edges in each vector. The cell overlaps where |a·p + b·q −
	// middle| ≤ reach.
	vec3 ex;
	vec3 ey;
	vec3 ez;
	vec3 reach_x;
	vec3 reach_y;
	vec3 reach_z;
	float reach_n;
};

vec3 longest_edge(tile t)
{
	vec3 d = dot(t.e1, t.e1) > dot(t.e2, t.e2) ? t.e1 : t.e2;
	return dot(t.e3, t.e3) > dot(d, d) ? t.e3 : d;
}

// The product of the two shorter edges, which has the least rounding error.
vec3 normal_of(tile t)
{
	float l1 = dot(t.e1, t.e1);
	float l2 = dot(t.e2, t.e2);
	float l3 = dot(t.e3, t.e3);
	vec3 a = l1 > max(l2, l3) ? t.e2 : t.e1;
	vec3 b = l3 > max(l1, l2) ? t.e2 : t.e3;
	return cross(a, b);
}

// The change of a triangle's height per column. A needle takes the slopes of its longest edge, which is never steep along
// the axis chosen for it.
vec2 slope_of(tile t)
{
	vec3 n = t.normal;
	if (t.needle) {
		vec3 d = longest_edge(t);
		d /= max(length(d), 1e-30);
		n = vec3(0.0, 0.0, 1.0) - d * d.z;
	}
	return n.z != 0.0 ? clamp(-n.xy / n.z, -1.5, 1.5) : vec2(0.0);
}

// The last cell that [low, high] touches. The upper end is exclusive unless it equals the lower one.
ivec3 last_cell(vec3 low, vec3 high)
{
	return max(ivec3(floor(low)), ivec3(ceil(high)) - 1);
}

void set_columns(inout tile t, uint bits)
{
	ivec3 first = ivec3(floor(t.low));
	ivec3 last = last_cell(t.low, t.high);
	ivec2 from = ivec2(bits & 1023u, bits >> VOXEL_TILE_B & 1023u);
	ivec2 to = from + ivec2(bits >> VOXEL_TILE_WIDTH & 3u, bits >> VOXEL_TILE_HEIGHT & 3u);
	t.first = max(from, first.xy);
	t.size = max(min(to, last.xy) - t.first + 1, ivec2(0));
	t.range = ivec2(first.z, last.z);
}

void set_axes(inout tile t)
{
	t.ex = vec3(t.e1.x, t.e3.x, t.e2.x);
	t.ey = vec3(t.e1.y, t.e3.y, t.e2.y);
	t.ez = vec3(t.e1.z, t.e3.z, t.e2.z);
	float h = 0.5 + 0.5 * VOXEL_SLACK;
	t.reach_x = 0.5 * abs(t.normal.x) + h * (abs(t.ey) + abs(t.ez));
	t.reach_y = 0.5 * abs(t.normal.y) + h * (abs(t.ez) + abs(t.ex));
	t.reach_z = 0.5 * abs(t.normal.z) + h * (abs(t.ex) + abs(t.ey));
	vec3 m = max(abs(t.e1), abs(t.e2));
	float l = max(m.x, max(m.y, m.z));
	// The rounding error of the normal itself matters for long triangles.
	t.reach_n = h * dot(abs(t.normal), vec3(1.0)) + 4e-7 * l * l * (l + 1.0);
}

tile tile_of(voxel_item item)
{
	tile t;
	triangle tri = triangles[item.triangle];
	vec3 v0 = to_vec3(vertices[tri.vertex[0]].position);
	vec3 v1 = to_vec3(vertices[tri.vertex[1]].position);
	vec3 v2 = to_vec3(vertices[tri.vertex[2]].position);
	float inverse = 1.0 / grid_low_side.w;
	t.id = item.triangle;
	t.k = item.tile >> VOXEL_TILE_AXIS & 3u;
	t.needle = (item.tile >> VOXEL_TILE_NEEDLE & 1u) != 0u;
	t.start = turn_axes((v0 - grid_low_side.xyz) * inverse, t.k);
	t.e1 = turn_axes((v1 - v0) * inverse, t.k);
	t.e2 = turn_axes((v2 - v0) * inverse, t.k);
	t.e3 = turn_axes((v2 - v1) * inverse, t.k);
	t.normal = normal_of(t);
	t.low = t.start + min(min(t.e1, t.e2), vec3(0.0));
	t.high = t.start + max(max(t.e1, t.e2), vec3(0.0));
	t.slope = slope_of(t);
	set_columns(t, item.tile);
	set_axes(t);
	return t;
}

// Whether a triangle overlaps the cell whose middle is at `q`, relative to the first corner. Their boxes must overlap.
bool overlaps(tile t, vec3 q)
{
	// The two ends of an edge differ from the third corner, along edge × axis, by ± the normal's component of that
	// axis.
	const vec3 half_sign = vec3(0.5, -0.5, -0.5);
	bvec3 x = lessThanEqual(abs(t.ey * q.z - t.ez * q.y - half_sign * t.normal.x), t.reach_x);
	bvec3 y = lessThanEqual(abs(t.ez * q.x - t.ex * q.z - half_sign * t.normal.y), t.reach_y);
	bvec3 z = lessThanEqual(abs(t.ex * q.y - t.ey * q.x - half_sign * t.normal.z), t.reach_z);
	return all(x) && all(y) && all(z) && abs(dot(t.normal, q)) <= t.reach_n;
}

// The state of a walk over a tile's cells.
struct walk {
	int column;        // 0 … size.x · size.y
	ivec3 cell;        // next cell to test
	int last;          // last cell of the column
};

void open_column(tile t, inout walk w)
{
	w.cell.xy = t.first + ivec2(w.column % t.size.x, w.column / t.size.x);
	float z = t.start.z + dot(t.slope, vec2(w.cell.xy) + 0.5 - t.start.xy);
	float reach = 0.5 * (abs(t.slope.x) + abs(t.slope.y)) + 0.1;
	w.cell.z = max(int(floor(z - reach)), t.range.x);
	w.last = min(int(floor(z + reach)), t.range.y);
}

walk walk_begin(tile t)
{
	walk w;
	w.column = 0;
	w.cell = ivec3(0);
	w.last = -1;
	if (t.size.x * t.size.y > 0)
		open_column(t, w);
	return w;
}

// Finds the next cell that the triangle overlaps, in rotated axes. False if there are no more.
bool walk_next(tile t, inout walk w, out ivec3 cell)
{
	bool found = false;
	int columns = t.size.x * t.size.y;
	while (!found && w.column < columns) {
		cell = w.cell;
		found = w.cell.z <= w.last && overlaps(t, vec3(w.cell) + 0.5 - t.start);
		w.cell.z++;
		if (w.cell.z > w.last) {
			w.column++;
			if (w.column < columns)
				open_column(t, w);
		}
	}
	return found;
}

// The bit of a cell (in rotated axes) and layer, or NONE outside of the grid.
uint bit_of(tile t, ivec3 turned, uint layer)
{
	ivec3 c = t.k == 0u ? turned.zxy : t.k == 1u ? turned.yzx : turned;
	uvec3 sides = grid_sides_entries.xyz;
	if (any(greaterThanEqual(uvec3(c), sides)))
		return NONE;
	return 2u * (uint(c.x) + sides.x * (uint(c.y) + sides.y * uint(c.z))) + layer;
}

// The layer of a triangle: 1 if the largest component of its normal is negative. That is the tile's z, except for a needle.
uint layer_of(tile t)
{
	vec3 n = t.normal;
	vec3 a = abs(n);
	float largest = !t.needle || a.z >= max(a.x, a.y) ? n.z : a.x > a.y ? n.x : n.y;
	return largest < 0.0 ? 1u : 0u;
}

// A pseudo-random number, 0 … 1, that depends only on the triangle and the cell.
float dither(tile t, ivec3 cell)
{
	uvec3 v = floatBitsToUint(t.start) ^ floatBitsToUint(t.e1).yzx * 0x9E3779B1u ^ floatBitsToUint(t.e2).zxy * 0x85EBCA77u;
	uint h = v.x * 0xC2B2AE3Du + v.y * 0x27D4EB2Fu + v.z * 0x165667B1u + uint(cell.x + cell.y * 513 + cell.z * 262657) * 0x9E3779B1u;
	h = (h ^ h >> 15) * 0x2C1B3C6Du;
	h = (h ^ h >> 12) * 0x297A2D39u;
	return float(h >> 9) * (1.0 / 8388608.0);
}

#endif
