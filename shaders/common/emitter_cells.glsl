// Places on textured emissive triangles, chosen by what the texture sends there: server/scene/emitter_cells.h. A triangle
// has n² congruent cells, n = 2^level. Cell (a, b), a + b < n, begins at the barycentrics (a, b) / n and is like the triangle;
// where a + b ≥ n it is the one upside down that ends at (n − a, n − b) / n.
#ifndef COMMON_EMITTER_CELLS_GLSL
#define COMMON_EMITTER_CELLS_GLSL

#include "common/light_tree.glsl"

SCENE_BUFFER(BIND_EMITTER_GRIDS) readonly buffer EmitterGrids {
	emitter_grid emitter_grids[];
};
SCENE_BUFFER(BIND_EMITTER_CELLS) readonly buffer EmitterCells {
	emitter_cell emitter_cells[];
};

// Chooses a cell of emitter `row` by 64 random bits. u becomes barycentrics of corners 1 and 2 of the triangle, uniform over
// the cell. Returns the cell's density, as in struct emitter_cell.
float cell_choose(uint row, uvec2 bits, inout vec2 u)
{
	emitter_grid g = emitter_grids[row];
	uint n = 1u << g.level;
	uint i, low;
	umulExtended(bits.x, n * n, i, low);
	emitter_cell c = emitter_cells[g.first + i];
	i = float(bits.y >> 8) * UNIT_24 < c.keep ? i : c.alias;
	uvec2 at = uvec2(i & (n - 1u), i >> g.level);
	u = (at.x + at.y < n ? vec2(at) + u : vec2(n - at) - u) / float(n);
	return emitter_cells[g.first + i].density;
}

// The density of the cell at a place of triangle `id`, which emits, and the mean of its triangle's.
vec2 cell_at(uint id, vec2 uv)
{
	uint row = emitter_of(id);
	emitter_grid g = emitter_grids[row];
	uint n = 1u << g.level;
	vec2 p = clamp(uv, 0.0, 1.0) * float(n);
	uvec2 at = min(uvec2(p), uvec2(n - 1u));
	vec2 f = p - vec2(at);
	bool over = at.x + at.y >= n; // by rounding, at the edge opposite to corner 0
	at.y = over ? n - 1u - at.x : at.y;
	bool upper = !over && f.x + f.y > 1.0 && at.x + at.y + 1u < n;
	at = upper ? n - 1u - at : at;
	float density = emitter_cells[g.first + (at.y << g.level) + at.x].density;
	return emitters[row].triangle == id ? vec2(density, g.share) : vec2(1.0);
}

#endif
