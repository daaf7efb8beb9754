// Between two products with the matrix: what a solver does element by element. A pass is compiled for each STEP_….
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require

#include "shared/solve.h"
#include "radiosity/pairs.glsl"

layout(local_size_x = SOLVE_LANES) in;
layout(constant_id = SPEC_STEP) const uint STEP = STEP_FOLD;

layout(push_constant) uniform Push {
	step_push push;
};
layout(std430, set = 0, binding = BIND_STEP_ALBEDO) readonly buffer Albedo {
	vec4 albedo[];
};
layout(std430, set = 0, binding = BIND_STEP_EXITANCE) readonly buffer Exitance {
	vec4 exitance[];
};
layout(std430, set = 0, binding = BIND_STEP_IRRADIANCE) readonly buffer Irradiance {
	vec4 irradiance[];
};
layout(std430, set = 0, binding = BIND_STEP_FIELD) buffer Field {
	vec4 field[];
};
layout(std430, set = 0, binding = BIND_STEP_SOURCE) buffer Source {
	vec4 source[];
};
layout(std430, set = 0, binding = BIND_STEP_SUMS) buffer Sums {
	vec4 sums[];
};
layout(std430, set = 0, binding = BIND_STEP_RESIDUAL) buffer Residual {
	vec4 residual[];
};
layout(std430, set = 0, binding = BIND_STEP_CHANGE) buffer Change {
	vec4 change[];
};
layout(std430, set = 0, binding = BIND_STEP_DIRECTION) buffer Direction {
	vec4 direction[];
};
layout(std430, set = 0, binding = BIND_STEP_IMAGE) buffer Image {
	vec4 image[];
};
layout(std430, set = 0, binding = BIND_STEP_MAXIMA) buffer Maxima {
	uint maxima[];
};
layout(std430, set = 0, binding = BIND_STEP_PARTS) writeonly buffer Parts {
	vec4 parts[];
};

#define WIDTH min(gl_SubgroupSize, uint(SOLVE_LANES))

// Raise a maximum over all elements. Every lane calls it, those without an element with 0.
void raise(uint which, vec3 value)
{
	for (uint mask = WIDTH / 2u; mask > 0u; mask /= 2u)
		value = max(value, subgroupShuffleXor(value, mask));
	if (gl_SubgroupInvocationID == 0u)
		for (uint c = 0u; c < 3u; c++)
			atomicMax(maxima[3u * which + c], floatBitsToUint(value[c])); // of numbers that are not negative
}

// Leave the subgroup's part of a sum over all elements. Every lane calls it, as raise().
void leave(uint which, vec3 value)
{
	for (uint mask = WIDTH / 2u; mask > 0u; mask /= 2u)
		value += subgroupShuffleXor(value, mask);
	if (gl_SubgroupInvocationID == 0u)
		parts[2u * ((push.first / SOLVE_LANES + gl_WorkGroupID.x) * gl_NumSubgroups + gl_SubgroupID) + which] =
		    vec4(value, 0.0);
}

vec3 scales()
{
	return vec3(push.scale[0], push.scale[1], push.scale[2]);
}

// H += scale e, and the source becomes B = M + ρ H, its upper digits and the rest. Maximum 0: B.
void fold(uint i, bool there)
{
	vec3 size = vec3(0.0);
	if (there) {
		vec3 lost, hi = field[2u * i].xyz, lo = field[2u * i + 1u].xyz;
		precise vec3 more = change[i].xyz * scales();
		hi = two_sum(hi, more, lost);
		lo += lost;
		settle_pair(hi, lo);
		field[2u * i] = vec4(hi, 0.0);
		field[2u * i + 1u] = vec4(lo, 0.0);
		precise vec3 rho = albedo[i].xyz;
		precise vec3 high = upper(rho);
		precise vec3 low = rho - high;
		precise vec3 first = upper(hi);
		precise vec3 second = hi - first;
		precise vec3 product = high * first; // exact
		precise vec3 rest = high * second + (low * first + (low * second + rho * lo));
		vec3 b = two_sum(exitance[i].xyz, product, lost);
		precise vec3 begin = upper(b);
		precise vec3 remains = (b - begin) + (lost + rest);
		source[2u * i] = vec4(begin, 0.0);
		source[2u * i + 1u] = vec4(remains, 0.0);
		size = abs(b);
	}
	raise(0u, size);
}

// r = D + F B - H. Maxima 1 and 2: ρ r and r.
void find_residual(uint i, bool there)
{
	vec3 r = vec3(0.0), rho = vec3(0.0);
	if (there) {
		vec3 lost, more;
		vec3 less = two_sum(sums[2u * i].xyz, -field[2u * i].xyz, lost);
		less = two_sum(less, irradiance[i].xyz, more);
		precise vec3 all = less + ((lost + more) + (sums[2u * i + 1u].xyz - field[2u * i + 1u].xyz));
		r = all;
		rho = albedo[i].xyz;
		residual[i] = vec4(r, 0.0);
	}
	raise(1u, abs(rho * r));
	raise(2u, abs(r));
}

// Begin to look for e = r + F ρ e in units of 1 / scale. The fourth scale is 1 if e begins with r, 0 if with 0.
void begin_change(uint i, bool there)
{
	if (!there)
		return;
	vec3 r = residual[i].xyz * scales();
	residual[i] = vec4(r, 0.0);
	change[i] = vec4(r * push.scale[3], 0.0);
	source[i] = vec4(albedo[i].xyz * r, 0.0);
	direction[i] = vec4(0.0);
	image[i] = vec4(0.0);
}

// e = r + F ρ e. Maxima 0 and 1: by how much ρ e changes, and ρ e.
void relax(uint i, bool there)
{
	vec3 by = vec3(0.0), size = vec3(0.0);
	if (there) {
		vec3 rho = albedo[i].xyz, e = residual[i].xyz + sums[2u * i].xyz;
		by = abs(rho * (e - change[i].xyz));
		size = abs(rho * e);
		change[i] = vec4(e, 0.0);
		source[i] = vec4(rho * e, 0.0);
	}
	raise(0u, by);
	raise(1u, size);
}

// The weight of an element in products of two vectors, A ρ: in this product F ρ is symmetric.
vec3 weight(uint i)
{
	return albedo[i].xyz * albedo[i].w;
}

// p = r + scale p, and q = (1 - F ρ) p. Parts 0 and 1: <r, q> and <q, q>.
void aim(uint i, bool there)
{
	vec3 rq = vec3(0.0), qq = vec3(0.0);
	if (there) {
		vec3 r = residual[i].xyz, q = r - sums[2u * i].xyz + scales() * image[i].xyz;
		direction[i] = vec4(r + scales() * direction[i].xyz, 0.0);
		image[i] = vec4(q, 0.0);
		rq = weight(i) * r * q;
		qq = weight(i) * q * q;
	}
	leave(0u, rq);
	leave(1u, qq);
}

// e += scale p, and r -= scale q. Maxima 0 and 1: ρ r and ρ e.
void move(uint i, bool there)
{
	vec3 r = vec3(0.0), e = vec3(0.0), rho = vec3(0.0);
	if (there) {
		rho = albedo[i].xyz;
		e = change[i].xyz + scales() * direction[i].xyz;
		r = residual[i].xyz - scales() * image[i].xyz;
		change[i] = vec4(e, 0.0);
		residual[i] = vec4(r, 0.0);
		source[i] = vec4(rho * r, 0.0);
	}
	raise(0u, abs(rho * r));
	raise(1u, abs(rho * e));
}

// Part 0: <(1 - F ρ) r, q>. Part 1: <r, r>.
void turn(uint i, bool there)
{
	vec3 zq = vec3(0.0), rr = vec3(0.0);
	if (there) {
		vec3 r = residual[i].xyz;
		zq = weight(i) * (r - sums[2u * i].xyz) * image[i].xyz;
		rr = weight(i) * r * r;
	}
	leave(0u, zq);
	leave(1u, rr);
}

// TEST_ONES: e = 1. TEST_LIT: e = 1 where B is not 0 by emission or light straight from lamps, else 0. TEST_REACHED: e = 1 also
// where light of such elements arrives; maximum 0: 1 where that is news. TEST_POWER: e = ρ F e; maxima 0 and 1: e, and how many
// times the one before it is.
void test(uint i, bool there)
{
	vec3 e = vec3(0.0), times = vec3(0.0), news = vec3(0.0);
	if (there) {
		vec3 before = change[i].xyz, rho = albedo[i].xyz;
		vec3 arrives = rho * sums[2u * i].xyz;
		if (push.scale[3] == TEST_ONES)
			e = vec3(1.0);
		else if (push.scale[3] == TEST_LIT)
			e = vec3(greaterThan(exitance[i].xyz + rho * irradiance[i].xyz, vec3(0.0)));
		else if (push.scale[3] == TEST_REACHED)
			e = max(before, vec3(greaterThan(arrives, vec3(0.0))));
		else
			e = arrives;
		news = e - before;
		times = mix(vec3(0.0), e / max(before, vec3(1e-37)), greaterThan(before, vec3(0.0)));
		change[i] = vec4(e, 0.0);
		source[i] = vec4(e, 0.0);
	}
	raise(0u, push.scale[3] == TEST_REACHED ? news : e);
	raise(1u, times);
}

void main()
{
	uint i = push.first + gl_GlobalInvocationID.x;
	bool there = i < push.end;
	if (STEP == STEP_FOLD)
		fold(i, there);
	else if (STEP == STEP_RESIDUAL)
		find_residual(i, there);
	else if (STEP == STEP_START)
		begin_change(i, there);
	else if (STEP == STEP_RELAX)
		relax(i, there);
	else if (STEP == STEP_AIM)
		aim(i, there);
	else if (STEP == STEP_MOVE)
		move(i, there);
	else if (STEP == STEP_TURN)
		turn(i, there);
	else
		test(i, there);
}
