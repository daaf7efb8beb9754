// Choosing a lamp by the tree over all of them (server/scene/light_tree.h). The walk goes down from the root. Each step
// takes a child with a probability proportional to an approximate bound of what the child's lamps could send here (Conty
// Estevez and Kulla 2018):
//     power · cos θ' · cos φ' / d²,   θ' = max(0, θ − spread − size),   φ' = max(0, φ − size).
// d is the distance to the node's middle, but at least half its diagonal. θ is the angle between the node's axis and the
// direction from it to here. φ is the angle between the surface's normal here and the direction to the node. `size` is the
// angle that the node subtends as seen from here. For directional lights the bound is power · cos φ', with their spread in
// place of the size and no distance. The product of the probabilities along the way is the lamp's probability. A lamp that
// BSDF sampling hit finds its probability again by its trail.
#ifndef COMMON_LIGHT_TREE_GLSL
#define COMMON_LIGHT_TREE_GLSL

#include "common/sampling.glsl"
#include "common/scene.glsl"

// struct light_node, three texels each. A texel buffer, because software drivers fetch texels for all lanes at once.
layout(set = 0, binding = BIND_LIGHT_NODES) uniform utextureBuffer light_texels;
SCENE_BUFFER(BIND_LIGHT_TRAILS) readonly buffer LightTrails {
	uint light_trails[];
};

const uint LIGHT_LEVELS = 32u;

light_node light_node_at(uint i)
{
	uvec4 a = texelFetch(light_texels, int(3u * i));
	uvec4 b = texelFetch(light_texels, int(3u * i + 1u));
	uvec4 c = texelFetch(light_texels, int(3u * i + 2u));
	vec4 low = uintBitsToFloat(a);
	vec4 high = uintBitsToFloat(b);
	vec4 axis = uintBitsToFloat(c);
	return light_node(float[3](low.x, low.y, low.z), low.w, float[3](high.x, high.y, high.z), high.w,
			  float[3](axis.x, axis.y, axis.z), c.w);
}

uint light_child(uint i)
{
	return texelFetch(light_texels, int(3u * i + 2u)).w;
}

// cos max(0, a − b) of two angles in 0…π, given their cosines and sines.
float cos_left(float cos_a, float sin_a, float cos_b, float sin_b)
{
	return cos_a >= cos_b ? 1.0 : cos_a * cos_b + sin_a * sin_b;
}

float sin_left(float cos_a, float sin_a, float cos_b, float sin_b)
{
	return cos_a >= cos_b ? 0.0 : sin_a * cos_b - cos_a * sin_b;
}

float sine_of(float cosine)
{
	return sqrt(max(0.0, 1.0 - cosine * cosine));
}

// Whether the lamps below a node are directional lights.
bool is_far(light_node n)
{
	return n.min[0] > n.max[0];
}

// The bound for a node of directional lights. `normal` is as in light_importance.
float far_importance(light_node n, vec3 normal)
{
	if (normal == vec3(0.0))
		return n.power;
	float up = -dot(to_vec3(n.axis), normal);
	return n.power * max(0.0, cos_left(up, sine_of(up), n.cos_spread, sine_of(n.cos_spread)));
}

// The bound for a node. `normal` is the geometric normal here on the side from which light comes, or zero if light may come
// from either side.
float light_importance(light_node n, vec3 here, vec3 normal)
{
	if (is_far(n))
		return far_importance(n, normal);
	vec3 low = to_vec3(n.min);
	vec3 high = to_vec3(n.max);
	vec3 to_here = here - 0.5 * (low + high);
	vec3 reach = 0.5 * (high - low);
	float r2 = dot(reach, reach);
	float d2 = dot(to_here, to_here);
	float near = min(n.power / max(max(d2, r2), 1e-30), 1e37);
	if (d2 <= r2)
		return near;
	// The bound is slightly enlarged, because both quantities are rounded.
	float sin_size = min(1.0, 1.001 * sqrt(r2 / d2) + 1e-4);
	float cos_size = sine_of(sin_size);
	float up = -dot(to_here, normal) * inversesqrt(d2);
	if (normal != vec3(0.0))
		near *= max(0.0, cos_left(up, sine_of(up), cos_size, sin_size));
	if (n.cos_spread <= -1.0)
		return near;
	float c = dot(to_here, to_vec3(n.axis)) * inversesqrt(d2);
	float sin_spread = sine_of(n.cos_spread);
	float s = sine_of(c);
	float c1 = cos_left(c, s, n.cos_spread, sin_spread);
	float s1 = sin_left(c, s, n.cos_spread, sin_spread);
	return near * max(0.0, cos_left(c1, s1, cos_size, sin_size));
}

// The bound for a node, less what the range of its light takes away if it is a leaf with one.
float ranged_importance(light_node n, vec3 here, vec3 normal)
{
	float bound = light_importance(n, here, normal);
	uint number = n.child & ~LIGHT_LEAF;
	if (RANGED_LIGHTS && n.child >= LIGHT_LEAF && number >= job.emitter_count && !is_far(n)) {
		vec3 to_here = here - to_vec3(n.min);
		bound *= within_range(lights[number - job.emitter_count].range, dot(to_here, to_here));
	}
	return bound;
}

// The probability of the second of a node's two children. Where neither child could send anything, power decides. Between
// local lamps and directional lights, neither gets less than a tenth: the latter are often a sun that does not reach into a
// room.
float second_chance(uint child, vec3 here, vec3 normal)
{
	light_node a = light_node_at(child);
	light_node b = light_node_at(child + 1u);
	float first = ranged_importance(a, here, normal);
	float second = ranged_importance(b, here, normal);
	if (!(first + second > 0.0)) {
		first = a.power;
		second = b.power;
	}
	float chance = second / (first + second);
	return is_far(a) != is_far(b) ? clamp(chance, 0.1, 0.9) : chance;
}

// Chooses a lamp for a place by two numbers of 32 random bits. Returns the lamp's number and, in `chance`, its probability.
uint light_tree_pick(vec3 here, vec3 normal, uvec2 pick, out float chance)
{
	uint child = light_child(0u);
	float u = float(pick.x >> 8) * UNIT_24;
	chance = 1.0;
	for (uint level = 0u; level < LIGHT_LEVELS && child < LIGHT_LEAF; level++) {
		float second = second_chance(child, here, normal);
		bool goes_second = u < second;
		float own = goes_second ? second : 1.0 - second;
		u = goes_second ? u / second : (u - second) / own;
		// Each level consumes digits of u: halfway down a deep tree it is replaced by fresh ones.
		u = level == 10u ? float(pick.y >> 8) * UNIT_24 : min(u, 0.99999994);
		chance *= own;
		child = light_child(child + (goes_second ? 1u : 0u));
	}
	return child & ~LIGHT_LEAF;
}

// The emitter of a triangle that is known to have one. Emitters are sorted by triangle.
uint emitter_of(uint id)
{
	uint low = 0u;
	uint high = job.emitter_count - 1u;
	for (uint i = 0u; i < LIGHT_LEVELS && low < high; i++) {
		uint middle = (low + high) / 2u;
		bool above = emitters[middle].triangle < id;
		low = above ? middle + 1u : low;
		high = above ? high : middle;
	}
	return low;
}

// The probability that light_tree_pick chooses the emitter of triangle `id` from here.
float light_tree_chance(vec3 here, vec3 normal, uint id)
{
	uint trail = light_trails[emitter_of(id)];
	uint child = light_child(0u);
	float chance = 1.0;
	for (uint level = 0u; level < LIGHT_LEVELS && child < LIGHT_LEAF; level++) {
		float second = second_chance(child, here, normal);
		bool goes_second = (trail >> level & 1u) != 0u;
		chance *= goes_second ? second : 1.0 - second;
		child = light_child(child + (goes_second ? 1u : 0u));
	}
	return chance;
}

#endif
