// The path tracer: one sample of every pixel of a run of tiles.
//
// Iterative. At every scattering event one light sample by next-event estimation and one direction by the BSDF, combined by
// multiple importance sampling (Veach 1997, chapter 9). A path that has more events than a dispatch may do is kept in
// BIND_PATHS and goes on in the next dispatch, bit for bit as if it had not been interrupted: some drivers end long loops.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "common/camera.glsl"
#include "common/light.glsl"
#include "path/accumulate.glsl"
#include "trace/traverse.glsl"

layout(local_size_x = TILE_SIDE, local_size_y = TILE_SIDE) in;

layout(push_constant) uniform Push {
	path_push push;
};
layout(std430, set = 0, binding = BIND_PATHS) buffer Paths {
	path_state paths[];
};
layout(std430, set = 0, binding = BIND_COUNTERS) buffer Counters {
	pt_counters counters;
};

// Whether a path may be longer than a dispatch. If not, it needs no place to wait.
layout(constant_id = SPEC_RESUMED) const bool RESUMED = true;

// Events before which a path is never ended by chance.
const uint ROULETTE_FROM = 4u;

void path_start(uvec2 pixel, sampler_state rnd, out path_state p)
{
	vec3 origin, direction;
	camera_ray(vec2(pixel) + sample_2d(rnd, SET_PIXEL), origin, direction);
	p.origin = float[3](origin.x, origin.y, origin.z);
	p.direction = float[3](direction.x, direction.y, direction.z);
	p.event = 0u;
	p.pdf = 0.0;
	p.throughput = float[3](1.0, 1.0, 1.0);
	p.radiance = float[3](0.0, 0.0, 0.0);
	p.rays = 0u;
	p.reserved = 0u;
}

// Weight of radiance that the BSDF's sampling found on an emissive triangle. The camera's ray is the only way there.
float emission_weight(uint event, float pdf_bsdf, float pdf_area, float t, float cos_light)
{
	if (event == 0u)
		return 1.0;
	float r = pdf_area * t * t / max(cos_light * pdf_bsdf, 1e-37);
	return power_weight(min(r, 1e18));
}

void path_run(inout path_state p, sampler_state rnd)
{
	vec3 origin = to_vec3(p.origin);
	vec3 direction = to_vec3(p.direction);
	vec3 throughput = to_vec3(p.throughput);
	vec3 radiance = to_vec3(p.radiance);
	float pdf = p.pdf;
	uint event = p.event;
	uint last = event + push.event_count;
	bool alive = true;

	while (alive && event < last) {
		ray_hit hit;
		bool found = trace_closest(origin, direction, hit);
		p.rays++;
		if (!found) {
			if (EFFECT_ENVIRONMENT)
				radiance += throughput * to_vec3(job.background);
			alive = false;
		} else {
			surface s = surface_at(hit.id, hit.uv, direction);
			if (EFFECT_EMITTERS) {
				float c = abs(dot(s.geometric, direction));
				radiance += throughput * s.emission * emission_weight(event, pdf, s.emission_pdf, hit.t, c);
			}
			uint most = EFFECT_BOUNCES ? job.depth : min(job.depth, 1u);
			alive = event < most && max(s.albedo.r, max(s.albedo.g, s.albedo.b)) > 0.0;
			if (alive) {
				uint set = event * SETS_PER_EVENT;
				vec2 chance = sample_2d(rnd, set + SET_CHANCE);
				origin = s.position + s.offset * s.geometric;
				if (EFFECT_EMITTERS || EFFECT_LIGHTS) {
					light_sample l;
					uvec2 pick = sample_bits(rnd, set + SET_PICK);
					vec2 u = sample_2d(rnd, set + SET_LIGHT);
					if (sample_light(s, origin, chance.y, pick, u, l)) {
						p.rays++;
						if (!trace_any(origin, l.segment, l.t_max))
							radiance += throughput * l.contribution;
					}
				}
				direction = lambert_sample(s, sample_2d(rnd, set + SET_BSDF));
				pdf = lambert_pdf(s, direction);
				throughput *= s.albedo;
				event++;
				if (event >= ROULETTE_FROM) {
					float stay = min(1.0, max(throughput.r, max(throughput.g, throughput.b)));
					alive = chance.x < stay;
					throughput /= stay;
				}
			}
		}
	}
	// A driver that cut the loop short left it with work to do and events to spend.
	trace_cut = trace_cut || (alive && event < last);
	p.origin = float[3](origin.x, origin.y, origin.z);
	p.direction = float[3](direction.x, direction.y, direction.z);
	p.throughput = float[3](throughput.r, throughput.g, throughput.b);
	p.radiance = float[3](radiance.r, radiance.g, radiance.b);
	p.pdf = pdf;
	p.event = alive ? event : PATH_DONE;
}

bool finite(vec3 c)
{
	// By exponent bits: a compiler may take isnan() for always false.
	uvec3 e = floatBitsToUint(c) & 0x7f800000u;
	return all(notEqual(e, uvec3(0x7f800000u)));
}

void main()
{
	uint tile = push.first_tile + gl_WorkGroupID.x;
	uvec2 pixel = uvec2(tile % job.tiles_x, tile / job.tiles_x) * TILE_SIDE + gl_LocalInvocationID.xy;
	if (gl_WorkGroupID.x >= push.tile_count || pixel.x >= job.width || pixel.y >= job.height)
		return;
	uint slot = gl_WorkGroupID.x * (TILE_SIDE * TILE_SIDE) + gl_LocalInvocationIndex;
	uint index = pixel.y * job.width + pixel.x;
	sampler_state rnd = sampler_make(index, push.sample_half, push.sample_index, job.seed[0], job.seed[1]);

	path_state p;
	if (RESUMED && push.first_event != 0u)
		p = paths[slot];
	else
		path_start(pixel, rnd, p);
	if (p.event == PATH_DONE)
		return;
	path_run(p, rnd);
	if (trace_cut)
		atomicAdd(counters.cut, 1u);
	if (p.event == PATH_DONE) {
		vec3 radiance = to_vec3(p.radiance);
		if (!finite(radiance)) {
			atomicAdd(counters.non_finite, 1u);
			radiance = vec3(0.0);
		}
		accumulate(index, push.sample_half, radiance);
		atomicAdd(counters.rays, p.rays);
	}
	if (RESUMED)
		paths[slot] = p;
}
