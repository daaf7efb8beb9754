// The path tracer: some samples of every pixel of a run of tiles.
//
// It is iterative. Every scattering event takes one light sample by next-event estimation and one direction by BSDF
// sampling, combined by multiple importance sampling (Veach 1997, chapter 9). A path with more events than a dispatch may
// do is kept in BIND_PATHS and resumed in the next dispatch, with bits equal to those of an uninterrupted run. This is
// needed because some drivers end long loops.
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require

#include "pt/ways.glsl"

#include "common/finite.glsl"
#include "common/light.glsl"
#include "common/tile.glsl"
#include "common/accumulate.glsl"
#include "pt/caustic.glsl"
#include "pt/dispatch.glsl"
#include "pt/lens.glsl"
#include "pt/media.glsl"
#include "pt/sky.glsl"
#include "shared/pt.h"

layout(local_size_x = TILE_PIXELS) in;

// Weight of radiance that BSDF sampling found on an emissive triangle. It is 1 for the camera's own ray, which no other
// technique samples.
float emission_weight(uint event, float pdf_bsdf, float pdf_area, float t, float cos_light)
{
	if (event == 0u || LAMPS_BY == LAMPS_BY_CHANCE)
		return 1.0;
	// Only BSDF sampling finds a mirror's direction.
	if (LAMPS_BY == LAMPS_BY_POINTS)
		return pdf_bsdf >= PDF_MIRROR ? 1.0 : 0.0;
	float r = pdf_area * t * t / max(cos_light * pdf_bsdf, 1e-37);
	return power_weight(min(r, 1e18));
}

// The state of a path while it runs. struct path_state is its form in memory.
struct walker {
	vec3 origin;
	vec3 direction;
	vec3 throughput;
	vec3 radiance;
	float pdf;
	uint event;
	uvec2 media;   // with EFFECT_GLASS: the clear bodies that contain it
	float rivals;  // with EFFECT_CAUSTICS: rivals_at, then rivals_beside of the first event; 0: it did not spread light
	float aim;     // caster_density at the last event / cosine of the outgoing direction; negative: no caster
	vec3 facing;   // with LIGHT_TREE: facing_of the surface at `origin`
	bool plain;    // with EFFECT_UNLIT: no event so far spread light but clear glass and metals
	uint taken;    // samples of this dispatch that are completed
	bool alive;
};

// Whether a surface that emits within `media` is inside two bodies. Such a surface has no light paths, because they do not
// know what surrounds the first body.
bool deep(uvec2 media)
{
	return EFFECT_GLASS && media_slot(media, 1u) != 0u;
}

// The weight, against light paths, of the light of a lamp that this path hit.
float keeps_of_lamp(walker p, surface s, float t, float cos_lamp)
{
	if (deep(p.media) || p.event < 2u || !(p.rivals > 0.0) || p.aim < 0.0 || !(s.emission_pdf > 0.0))
		return 1.0;
	float c = arriving(cos_lamp / (PI * t * t), p.aim, false);
	return camera_keeps(p.rivals, lamp_density(c, p.pdf, min(cos_lamp / (t * t * s.emission_pdf), 1e18)));
}

// The weight, against light paths, of the light of the environment map.
float keeps_of_sky(walker p)
{
	if (p.event < 2u || !(p.rivals > 0.0) || p.aim < 0.0 || !(job.sky_paths > 0.0))
		return 1.0;
	return camera_keeps(p.rivals, lamp_density(arriving(0.0, p.aim, true), p.pdf, path_inverse(sky_at(p.direction))));
}

// The weight, against light paths, of next-event estimation at this event. `beyond` are the bodies on the surface's far
// side.
float keeps_of_choice(walker p, surface s, uvec2 beyond, light_choice c, float pdf)
{
	// Only a point of an emissive surface has both an end and a competing BSDF density: the environment map has no end,
	// and a punctual light no competitor.
	bool own = c.t_max == 1.0 && c.inverse > 0.0 && deep(dot(c.w, s.geometric) < 0.0 ? beyond : p.media);
	if (own || p.event < 1u || !(p.rivals > 0.0) || !casts(s.material, pdf))
		return 1.0;
	float aimed = caster_density[s.material] / max(abs(dot(c.w, s.geometric)), 1e-30);
	return camera_keeps(p.rivals, lamp_density(arriving(c.spread, aimed, c.t_max != 1.0), pdf, c.by_power));
}

// Notes what the weights need of this event, which has chosen p.direction.
void caustic_note(inout walker p, surface s)
{
	float cosine = abs(dot(p.direction, s.geometric));
	if (p.event == 0u)
		p.rivals = p.pdf < PDF_MIRROR ? rivals_beside(p.rivals, p.pdf, cosine) : 0.0;
	p.aim = casts(s.material, p.pdf) ? caster_density[s.material] / max(cosine, 1e-30) : -1.0;
}

// For a light on the far side of the surface, starts the shadow ray there. Applies the absorption of the medium in between.
void light_through(surface s, uvec2 media, uvec2 beyond, inout vec3 from, inout light_sample l)
{
	bool through = dot(s.geometric, l.segment) < 0.0;
	vec3 other = s.position - s.offset * s.geometric;
	bool ends = l.t_max == 1.0;
	if (through) {
		l.segment -= ends ? other - from : vec3(0.0);
		from = other;
	}
	if (ends)
		l.contribution *= media_transmittance(through ? beyond : media, length(l.segment));
}

// A scattering event: one light sample, then the next direction. `l.t_max` is -1 if no light can come; otherwise the shadow
// ray starts at `from`.
void scatter(inout walker p, surface s, sampler_state rnd, inout light_sample l, out vec3 from)
{
	uint set = p.event * SETS_PER_EVENT;
	vec2 chance = sample_2d(rnd, set + SET_CHANCE);
	uvec2 beyond = p.media;
	if (EFFECT_GLASS)
		beyond = choose_clear(s, p.media, sample_2d(rnd, set + SET_CLEAR).x);
	bsdf b = bsdf_make(s, p.direction);
	p.origin = s.position + s.offset * s.geometric;
	from = p.origin;
	l.t_max = -1.0;
	if (EFFECT_EMITTERS || EFFECT_LIGHTS || SKY) {
		uvec2 pick = sample_bits(rnd, set + SET_PICK);
		vec2 place = sample_2d(rnd, set + SET_LIGHT);
		uvec2 cell = EMITTER_CELLS ? sample_bits(rnd, set + SET_CELL) : uvec2(0u);
		light_choice c;
		bool some = sky_chosen(chance.y) ? choose_sky(pick, place, c)
						 : choose_light(b, p.origin, chance.y, pick, cell, place, c);
		if (some && light_scattered(b, c, l))
			l.contribution *= p.throughput * (EFFECT_CAUSTICS ? keeps_of_choice(p, s, beyond, c, l.pdf) : 1.0);
		else
			l.t_max = -1.0;
		if (EFFECT_GLASS && l.t_max > 0.0)
			light_through(s, p.media, beyond, from, l);
	}
	if (LIGHT_TREE)
		p.facing = facing_of(b);
	vec3 weight;
	float lobe = EFFECT_GLOSSY || EFFECT_GLASS || EFFECT_CLEARCOAT ? sample_2d(rnd, set + SET_LOBE).x : 0.0;
	p.direction = bsdf_sample(b, lobe, sample_2d(rnd, set + SET_BSDF), weight, p.pdf);
	p.throughput *= weight;
	if (EFFECT_CAUSTICS)
		caustic_note(p, s);
	p.alive = max(weight.r, max(weight.g, weight.b)) > 0.0;
	bool image = p.pdf >= PDF_MIRROR || (EFFECT_GLASS && b.clear) || b.diffuse == vec3(0.0);
	p.plain = p.plain && image;
	float worth = 1.0;
	if (EFFECT_GLASS) {
		bool through = dot(p.direction, s.geometric) < 0.0;
		p.media = through ? beyond : p.media;
		p.origin = through ? s.position - s.offset * s.geometric : p.origin;
		// Radiance falls to 1/η² on the way in and grows back on the way out. Russian roulette must not count that.
		worth = media_index(p.media) * media_index(p.media);
	}
	p.event++;
	if (WAY_ROULETTE && p.event >= ROULETTE_FROM) {
		float stay = min(1.0, worth * max(p.throughput.r, max(p.throughput.g, p.throughput.b)));
		p.alive = p.alive && chance.x < stay;
		p.throughput /= max(stay, 1e-30);
	}
}

// Handles what the path's ray hit: adds emission. Returns whether there is a surface to scatter at.
bool arrive(inout walker p, bool found, ray_hit hit, out surface s)
{
	if (!found) {
		if (SKY)
			p.radiance += p.throughput * (EFFECT_CAUSTICS ? keeps_of_sky(p) : 1.0) * sky_met(p.direction, p.event, p.pdf);
		else if (EFFECT_ENVIRONMENT)
			p.radiance += p.throughput * to_vec3(job.background);
		return false;
	}
	s = surface_at(hit.id, hit.uv, p.origin, p.direction, hit.t);
	if (EFFECT_GLASS) {
		p.media = media_before(p.media, s);
		p.throughput *= media_transmittance(p.media, hit.t);
	}
	if (EFFECT_EMITTERS) {
		if (EFFECT_CLEARCOAT && s.coat > 0.0)
			s.emission *= coat_lets(s.coat_normal, -p.direction, s.coat, s.coat_roughness);
		float c = abs(dot(s.geometric, p.direction));
		vec2 cell = EMITTER_CELLS && s.emission_pdf > 0.0 ? cell_at(hit.id, hit.uv) : vec2(1.0);
		s.emission_pdf *= cell.x;
		float pdf_area = p.event == 0u ? 0.0 : emitter_density(p.origin, p.facing, hit.id, s.emission_pdf, cell);
		float weight = emission_weight(p.event, p.pdf, pdf_area, hit.t, c);
		if (EFFECT_CAUSTICS)
			weight *= keeps_of_lamp(p, s, hit.t, c);
		p.radiance += p.throughput * s.emission * weight;
	}
	if (EFFECT_CAUSTICS && p.event == 0u)
		p.rivals = rivals_at(p.direction, hit.t, abs(dot(s.geometric, p.direction)), push.light_tiles * TILE_PIXELS);
	if (EFFECT_UNLIT && s.unlit) {
		// An unlit surface neither receives nor gives light. It is seen by the camera, and by way of what shows
		// images: mirrors, clear glass and metals.
		if (p.plain)
			p.radiance += p.throughput * s.base;
		return false;
	}
	uint most = EFFECT_BOUNCES ? job.depth : min(job.depth, 1u);
	vec3 reflects = max(s.albedo, max(s.f0, s.f90));
	bool lets = (EFFECT_GLASS && s.transmission > 0.0) || (EFFECT_CLEARCOAT && s.coat > 0.0);
	return p.event < most && (lets || max(reflects.r, max(reflects.g, reflects.b)) > 0.0);
}

// The counters of a lane during a dispatch.
struct tally {
	uint rays;
	uint non_finite;
	uint rounds;
	uint clamped;
	float removed;
	bool met;      // a camera ray met a surface
};

uint half_of(uint taken)
{
	return (push.first_sample + taken) & 1u;
}

// The index of the pixel's first sample in its sequence.
uint run_start = 0u;

sampler_state sampler_of(uvec2 scrambles, uint taken)
{
	uint sample_number = push.first_sample + taken;
	return sampler_state(run_start + (sample_number >> 1), half_of(taken) == 0u ? scrambles.x : scrambles.y);
}

// The scrambles for the two halves of a pixel's samples.
uvec2 pixel_scrambles(uvec2 pixel, uint index)
{
	uint from = index;
	if (WAY_SAMPLER == SAMPLER_BLUE) {
		uvec2 run = sampler_run(pixel, job.run_bits);
		run_start = run.x;
		from = run.y;
	}
	return uvec2(sampler_make(from, 0u, 0u, job.seed[0], job.seed[1]).scramble,
		     sampler_make(from, 1u, 0u, job.seed[0], job.seed[1]).scramble);
}

void path_start(inout walker p, uvec2 pixel, uvec2 scrambles)
{
	sampler_state rnd = sampler_of(scrambles, p.taken);
	vec2 at = vec2(pixel) + sample_filter(sample_2d(rnd, SET_PIXEL));
	lens_ray(at, CAMERA == CAMERA_LENS ? sample_2d(rnd, SET_LENS) : vec2(0.5), p.origin, p.direction);
	p.throughput = vec3(1.0);
	p.radiance = vec3(0.0);
	p.pdf = 0.0;
	p.event = 0u;
	p.plain = true;
	p.media = uvec2(0u);
	p.rivals = 0.0;
	p.aim = 0.0;
	p.facing = vec3(0.0);
	p.alive = true;
}

// Clamps a sample that is brighter than the request allows. It keeps its colour, and the removed luminance is counted.
void path_clamp(inout walker p, inout tally account)
{
	float brightest = max(p.radiance.r, max(p.radiance.g, p.radiance.b));
	if (!(brightest > job.clamp))
		return;
	vec3 kept = p.radiance * (job.clamp / brightest);
	account.clamped++;
	account.removed += luminance(p.radiance - kept) / job.clamp;
	p.radiance = kept;
}

void path_finish(inout walker p, inout tally account)
{
	bool whole = finite(p.radiance);
	if (WAY_CLAMP && whole)
		path_clamp(p, account);
	account.non_finite += whole ? 0u : 1u;
	sums_add(half_of(p.taken), whole ? p.radiance : vec3(0.0));
	p.taken++;
}

// One scattering event.
void path_round(inout walker p, sampler_state rnd, inout tally account)
{
	bool running = p.alive;
	ray_hit hit;
	if (EFFECT_ALPHA_BLEND) {
		trace_chance = hash_combine(rnd.scramble, SET_ALPHA + p.event);
		trace_index = rnd.index;
	}
	bool found = trace_closest(p.origin, p.direction, running ? INFINITY : -1.0, hit);
	light_sample l;
	l.t_max = -1.0;
	l.segment = vec3(0.0, 0.0, 1.0);
	l.contribution = vec3(0.0);
	vec3 from = p.origin;
	if (running) {
		account.rays++;
		account.met = account.met || (found && p.event == 0u);
		surface s;
		p.alive = arrive(p, found, hit, s);
		if (p.alive)
			scatter(p, s, rnd, l, from);
	}
	if (EFFECT_EMITTERS || EFFECT_LIGHTS || SKY) {
		if (EFFECT_ALPHA_BLEND)
			trace_chance = ~trace_chance;
		bool shadowed = trace_any(from, l.segment, l.t_max);
		if (l.t_max > 0.0) {
			account.rays++;
			if (!shadowed)
				p.radiance += l.contribution;
		}
	}
}

// Up to push.round_count events. When a lane's path ends, the lane starts its pixel's next sample at once, so that lanes do
// not wait for longer paths of their neighbours while samples are left. All lanes of a subgroup loop together, so that they
// trace together; those without samples left trace nothing.
void path_run(inout walker p, uvec2 pixel, uvec2 scrambles, inout tally account)
{
	bool more = subgroupAny(p.alive);
	if (more) do {
		bool running = p.alive;
		path_round(p, sampler_of(scrambles, p.taken), account);
		if (running && !p.alive) {
			path_finish(p, account);
			if (p.taken < push.sample_count)
				path_start(p, pixel, scrambles);
		}
		account.rounds++;
		more = account.rounds < push.round_count && subgroupAny(p.alive);
	} while (more);
	// If paths are unfinished although rounds are left, the driver has ended the loop.
	trace_cut = trace_cut || (p.alive && account.rounds < push.round_count);
}

void path_load(uint slot, out walker p)
{
	path_state s = paths[slot];
	p = walker(to_vec3(s.origin), to_vec3(s.direction), to_vec3(s.throughput), to_vec3(s.radiance), s.pdf, s.event,
		   uvec2(s.media[0], s.media[1]), s.rivals, s.aim, to_vec3(s.facing), (s.taken & PATH_PLAIN) != 0u, s.taken & ~PATH_PLAIN,
		   s.event != PATH_DONE);
}

void path_store(uint slot, walker p)
{
	paths[slot].origin = float[3](p.origin.x, p.origin.y, p.origin.z);
	paths[slot].event = p.alive ? p.event : PATH_DONE;
	paths[slot].direction = float[3](p.direction.x, p.direction.y, p.direction.z);
	paths[slot].pdf = p.pdf;
	paths[slot].throughput = float[3](p.throughput.r, p.throughput.g, p.throughput.b);
	paths[slot].taken = p.taken | (p.plain ? PATH_PLAIN : 0u);
	paths[slot].media = uint[2](p.media.x, p.media.y);
	paths[slot].rivals = p.rivals;
	paths[slot].aim = p.aim;
	paths[slot].facing = float[3](p.facing.x, p.facing.y, p.facing.z);
	paths[slot].radiance = float[3](p.radiance.r, p.radiance.g, p.radiance.b);
}

// Adds the lane's counters to the host's.
void give_account(tally account)
{
	count_work(account.rays, account.non_finite, account.rounds);
	if (account.met)
		met_note(push.first_tile + gl_WorkGroupID.x, gl_LocalInvocationIndex);
	if (WAY_CLAMP && account.clamped > 0u) {
		atomicAdd(counters.clamped, account.clamped);
		// A 64-bit integer, so that the sum does not depend on the order.
		uint removed = uint(min(account.removed * float(CLAMP_UNITS), 4.0e9));
		uint before = atomicAdd(counters.removed[0], removed);
		if (before + removed < before)
			atomicAdd(counters.removed[1], 1u);
	}
}

void main()
{
	uvec2 pixel = tile_pixel(push.first_tile + gl_WorkGroupID.x, job.tiles_x);
	bool mine = gl_WorkGroupID.x < push.tile_count && pixel.x < job.width && pixel.y < job.height;
	uint slot = gl_WorkGroupID.x * TILE_PIXELS + gl_LocalInvocationIndex;
	uint index = pixel.y * job.width + pixel.x;
	uint at = index - push.first_row * job.width;
	uvec2 scrambles = pixel_scrambles(pixel, index);

	walker p;
	p.taken = 0u;
	if (RESUMED && push.resumes != 0u)
		path_load(slot, p);
	else
		path_start(p, pixel, scrambles);
	p.alive = p.alive && mine;
	bool had_work = p.alive;
	if (had_work)
		sums_load(at);
	tally account = tally(0u, 0u, 0u, 0u, 0.0, false);
	path_run(p, pixel, scrambles, account);
	if (!had_work)
		return;
	give_account(account);
	sums_store(at);
	if (RESUMED)
		path_store(slot, p);
}
