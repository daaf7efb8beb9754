// Next-event estimation. A call chooses one light by power, from an alias table, then a point on it. A program that defines
// the constant LIGHT_TREE as true chooses by the tree over all lamps instead; one that defines EMITTER_CELLS as true chooses
// points of textured triangles by their cells.
#ifndef COMMON_LIGHT_GLSL
#define COMMON_LIGHT_GLSL

#include "common/bsdf.glsl"
#ifdef LIGHT_TREE
#include "common/light_tree.glsl"
#endif
#ifdef EMITTER_CELLS
#include "common/emitter_cells.glsl"
#endif

#ifndef LAMPS_BY
#define LAMPS_BY LAMPS_BY_BOTH
#endif

// Whether directional lights may shine from a disc.
#ifndef DISC_LIGHTS
#define DISC_LIGHTS false
#endif

// What next-event estimation sampled. Visibility is not yet known.
struct light_sample {
	vec3 contribution;   // BSDF × cosine × radiance × weight / density; to be multiplied by the path's throughput
	vec3 segment;        // from the ray's origin to the light, which is at t = 1
	float t_max;         // 1, or infinite for a directional light
	float pdf;           // density of this direction by BSDF sampling, 1/sr
};

// A row of an alias table (Walker), from 64 random bits: the high half of the product of the first 32 and the count is the
// row; the second 32 decide between it and its alias.
uint alias_row(uint bits, uint count)
{
	uint row, low;
	umulExtended(bits, count, row, low);
	return row;
}

// A point of an emissive triangle as seen from a receiver.
struct emitter_view {
	vec3 segment;   // from the receiver to the point; at t = 1 it ends in front of the lamp itself
	vec3 radiance;  // towards the receiver
	float inverse;  // 1 / density, by solid angle, of the choice
	float by_power; // the same, had it been chosen by power
	float spread;   // 1/m²: share of its light, emitted by Lambert's law, per unit area that faces it at the receiver
};

// The normal of the side from which light reaches a surface: its geometric normal, or zero if light may come from either
// side.
vec3 facing_of(bsdf b)
{
	return EFFECT_GLASS && b.clear ? vec3(0.0) : b.geometric;
}

// The lamp that was chosen.
struct lamp_pick {
	bool emissive;
	uint number;     // of the triangle or of the punctual light
	uint row;        // of an emissive triangle: its emitter
	float density;   // of an emissive triangle: over its area, 1/m², uniform; of a punctual light: its probability
	float cell;      // with EMITTER_CELLS: density of the chosen cell, which `density` contains; else 1
};

// Chooses an emissive triangle by power.
lamp_pick pick_emitter(uvec2 pick)
{
	uint row = alias_row(pick.x, job.emitter_count);
	emitter e = emitters[row];
	bool keep = float(pick.y >> 8) * UNIT_24 < e.keep;
	uint id = keep ? e.triangle : emitters[e.alias].triangle;
	return lamp_pick(true, id, keep ? row : e.alias, materials[triangles[id].material].power_density * job.emitter_power_inv, 1.0);
}

// Chooses a punctual light by power.
lamp_pick pick_light(uvec2 pick)
{
	uint number = alias_row(pick.x, job.light_count);
	punctual_light light = lights[number];
	bool keep = float(pick.y >> 8) * UNIT_24 < light.keep;
	number = keep ? number : light.alias;
	return lamp_pick(false, number, 0u, lights[number].pmf, 1.0);
}

#ifdef LIGHT_TREE
// Chooses a lamp by the tree for a surface at `origin`. `facing` is the surface's facing_of.
lamp_pick pick_by_tree(vec3 origin, vec3 facing, uvec2 pick)
{
	float chance;
	uint number = light_tree_pick(origin, facing, pick, chance);
	chance *= job.emitter_share + job.light_share;
	if (number >= job.emitter_count)
		return lamp_pick(false, number - job.emitter_count, 0u, chance, 1.0);
	uint id = emitters[number].triangle;
#ifdef EMITTER_CELLS
	chance /= EMITTER_CELLS ? emitter_grids[number].share : 1.0;
#endif
	return lamp_pick(true, id, number, chance / max(area_of(corners_of(triangles[id])), 1e-37), 1.0);
}
#endif

// Chooses a point of the lamp, an emissive triangle, by u and, if it has cells, by 64 random bits: barycentrics of corners 1
// and 2.
vec2 place_on(inout lamp_pick lamp, uvec2 bits, vec2 u)
{
	u = sample_triangle(u);
#ifdef EMITTER_CELLS
	if (EMITTER_CELLS) {
		lamp.cell = cell_choose(lamp.row, bits, u);
		lamp.density *= lamp.cell;
	}
#endif
	return u;
}

// The density over area, 1/m², with which choosing a lamp and a point on it gives a particular point of the emissive
// triangle `id`, for a receiver at `origin`. `by_power` is the same, were the lamp chosen by power; `cell` is cell_at.
float emitter_density(vec3 origin, vec3 facing, uint id, float by_power, vec2 cell)
{
#ifdef LIGHT_TREE
	if (LIGHT_TREE && by_power > 0.0)
		return light_tree_chance(origin, facing, id) * (job.emitter_share + job.light_share) /
		       max(area_of(corners_of(triangles[id])), 1e-37) * (cell.x / cell.y);
#endif
	return by_power;
}

// Radiance, W/(m² sr), that a point of an emissive triangle with normal n sends towards w, from the side that w is on.
vec3 emitted_towards(material m, triangle tri, vec3 n, vec2 uv, vec3 w)
{
	vec3 bary = vec3(1.0 - uv.x - uv.y, uv);
	vec4 at = EFFECT_TEXTURES || EFFECT_NORMAL_MAPS ? coordinates_at(tri, bary) : vec4(0.0);
	vec3 radiance = emission_at(m, at);
	if (EFFECT_ALPHA_MASK || EFFECT_ALPHA_BLEND)
		radiance *= coverage_at(m, tri, bary, at);
	if (EFFECT_CLEARCOAT && m.coat > 0.0) {
		vec3 nc = coat_normal_at(m, tri, bary, at, mesh_normal(tri, bary, n));
		vec2 coat = coat_at(m, at);
		radiance *= coat_lets(dot(n, w) < 0.0 ? -nc : nc, w, coat.x, coat.y);
	}
	return radiance;
}

// The point of an emissive triangle at barycentrics uv of corners 1 and 2. False if the receiver sees its dark side or its
// edge.
bool view_emitter(vec3 origin, lamp_pick lamp, vec2 uv, out emitter_view v)
{
	triangle tri = triangles[lamp.number];
	material m = materials[tri.material];
	corners k = corners_of(tri);
	vec3 n = k.normal;

	vec3 q = k.v0 + uv.x * (k.v1 - k.v0) + uv.y * (k.v2 - k.v0);
	float away = dot(n, origin - q);
	bool lit = away > 0.0 || (m.flags & MATERIAL_EMITS_BOTH_SIDES) != 0u;
	// The target is moved off the light's plane towards the receiver, for the same reason that the ray's origin is.
	q += (away < 0.0 ? -n : n) * segment_offset(k, origin);

	v.segment = q - origin;
	float d2 = dot(v.segment, v.segment);
	float d = sqrt(max(d2, 1e-37));
	vec3 w = v.segment / d;
	float cos_light = abs(dot(n, w));
	v.radiance = vec3(0.0);
	v.inverse = 0.0;
	v.by_power = 0.0;
	v.spread = 0.0;
	if (!lit || !(d2 > 0.0) || cos_light == 0.0)
		return false;
	v.inverse = min(cos_light / (d2 * lamp.density), 1e18);
	v.by_power = min(cos_light / (d2 * m.power_density * job.emitter_power_inv * job.emitter_share * lamp.cell), 1e18);
	v.spread = cos_light / (PI * d2);
	v.radiance = emitted_towards(m, tri, n, uv, -w);
	return true;
}

// What next-event estimation chose, before the BSDF is evaluated. All kinds of light lead to this structure, so that the
// BSDF's code exists once: some drivers take long to compile it.
struct light_choice {
	vec3 w;         // towards the light, unit
	vec3 radiance;  // W/(m² sr); for a light that BSDF sampling cannot hit, irradiance, W/m²
	float scale;    // 1 / density of the choice
	float inverse;  // × density of BSDF sampling = ratio of the two densities; 0: BSDF sampling cannot find it
	vec3 segment;   // as in light_sample
	float t_max;
	// For the weights of pt/caustic.glsl:
	float by_power; // `inverse`, had the light been chosen by power
	float spread;   // 1/m²: share of its light, by its own law, per unit area that faces it here; 0: light from afar
};

// Evaluates the BSDF for a choice. False if nothing is scattered.
bool light_scattered(bsdf b, light_choice c, out light_sample l)
{
	l.segment = c.segment;
	l.t_max = c.t_max;
	vec4 f = bsdf_eval(b, c.w);
	l.pdf = f.w;
	// The bound keeps f · scale · weight finite, however near the light is.
	float weight = LAMPS_BY == LAMPS_BY_POINTS ? 1.0 : power_weight(min(f.w * c.inverse, 1e18));
	l.contribution = f.xyz * c.radiance * (c.scale * weight);
	return f.w != 0.0;
}

// 1 − cos of the angle between two unit vectors. The cosine itself has no digits left where the angle is small.
float spread_between(vec3 a, vec3 b)
{
	return 0.5 * dot(a - b, a - b);
}

// `w` is the unit vector from the light.
float spot_attenuation(punctual_light light, vec3 w)
{
	// Khronos, KHR_lights_punctual: squared linear ramp between the two cones' cosines.
	float ramp = (light.outer - spread_between(w, to_vec3(light.direction))) / max(light.outer - light.inner, 1e-30);
	ramp = clamp(ramp, 0.0, 1.0);
	return ramp * ramp;
}

// Irradiance, W/m², that a punctual light causes on a plane at `origin` that faces it. w is the unit vector to the light;
// `segment` to the light ends at t_max.
vec3 punctual_irradiance(punctual_light light, vec3 origin, out vec3 w, out vec3 segment, out float t_max)
{
	vec3 to_light = to_vec3(light.position) - origin;
	float d2 = dot(to_light, to_light);
	float away2 = max(d2, 1e-37);
	bool directional = light.kind == LIGHT_DIRECTIONAL;
	w = directional ? -to_vec3(light.direction) : to_light / sqrt(away2);
	segment = directional ? w : to_light;
	t_max = directional ? INFINITY : 1.0;
	vec3 irradiance = to_vec3(light.intensity);
	if (!directional)
		irradiance /= away2;
	if (RANGED_LIGHTS && !directional)
		irradiance *= within_range(light.range, d2);
	if (light.kind == LIGHT_SPOT)
		irradiance *= spot_attenuation(light, -w);
	return directional || d2 > 0.0 ? irradiance : vec3(0.0);
}

// 1 − cos of the angle from its direction within which a point or spot light emits.
float punctual_extent(punctual_light light)
{
	return light.kind == LIGHT_SPOT ? light.outer : 2.0;
}

// The density, 1/sr, of a uniform choice among the directions that a point or spot light emits in; 0 for a directional
// light.
float punctual_spread(punctual_light light)
{
	return light.kind == LIGHT_DIRECTIONAL ? 0.0 : 1.0 / (2.0 * PI * max(punctual_extent(light), 1e-30));
}

// Samples a direction within the disc of a directional light, uniformly by solid angle; w is the disc's middle. The disc
// has uniform radiance L, so its irradiance E on a plane that faces the middle is π sin² α L for a half aperture α. A
// sample from the solid angle 2π (1 − cos α) therefore stands for the irradiance E · 2 / (1 + cos α) from its direction.
vec3 in_disc(punctual_light light, vec3 w, vec2 u, inout vec3 irradiance)
{
	float lower = u.x * light.spread; // 1 − cos of the angle from the middle
	float across = sqrt(lower * (2.0 - lower));
	float turn = 6.28318530717958648 * u.y;
	vec3 x, y;
	frame_make(w, x, y);
	irradiance *= 2.0 / (2.0 - light.spread);
	return normalize((1.0 - lower) * w + across * (cos(turn) * x + sin(turn) * y));
}

bool choose_point(vec3 origin, lamp_pick lamp, uvec2 cell, vec2 u, out light_choice c)
{
	emitter_view v;
	vec2 uv = place_on(lamp, cell, u);
	bool lit = view_emitter(origin, lamp, uv, v);
	c = light_choice(v.segment / max(length(v.segment), 1e-37), v.radiance, v.inverse, v.inverse, v.segment, 1.0,
			 v.by_power, v.spread);
	return lit;
}

bool choose_punctual(vec3 origin, lamp_pick lamp, vec2 u, out light_choice c)
{
	punctual_light light = lights[lamp.number];
	c.radiance = punctual_irradiance(light, origin, c.w, c.segment, c.t_max);
	if (DISC_LIGHTS && light.spread > 0.0)
		c.segment = c.w = in_disc(light, c.w, u, c.radiance);
	c.scale = 1.0 / lamp.density;
	c.inverse = 0.0;
	c.by_power = 0.0;
	c.spread = punctual_spread(light) / max(dot(c.segment, c.segment), 1e-30);
	return c.radiance != vec3(0.0);
}

// Chooses a lamp: `table` decides between emissive triangles and punctual lights, `pick` which of them.
lamp_pick pick_lamp(vec3 origin, vec3 facing, float table, uvec2 pick)
{
#ifdef LIGHT_TREE
	if (LIGHT_TREE)
		return pick_by_tree(origin, facing, pick);
#endif
	bool emissive = EFFECT_EMITTERS && job.emitter_count > 0u &&
			(!EFFECT_LIGHTS || job.light_count == 0u || table < job.emitter_share);
	lamp_pick lamp;
	if (emissive)
		lamp = pick_emitter(pick);
	else
		lamp = pick_light(pick);
	lamp.density *= emissive ? job.emitter_share : job.light_share;
	return lamp;
}

// Chooses a light and, by `cell` and u, a point on it. False if this sample brings no light, or if the light is left to BSDF
// sampling.
bool choose_light(bsdf b, vec3 origin, float table, uvec2 pick, uvec2 cell, vec2 u, out light_choice c)
{
	bool some = (EFFECT_EMITTERS && job.emitter_count > 0u) || (EFFECT_LIGHTS && job.light_count > 0u);
	if (!some)
		return false;
	lamp_pick lamp = pick_lamp(origin, facing_of(b), table, pick);
	if (lamp.emissive)
		return EFFECT_EMITTERS && LAMPS_BY != LAMPS_BY_CHANCE && choose_point(origin, lamp, cell, u, c);
	return EFFECT_LIGHTS && choose_punctual(origin, lamp, u, c);
}

#endif
