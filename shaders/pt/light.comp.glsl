// Light paths: from lamps by way of polished surfaces to surfaces that the camera sees (light tracing: Arvo 1986; Dutré,
// Lafortune and Willems 1993). A sample of a band has one light path for every few pixels. Their contributions go to the
// band's film.
//
// The first event must be on a caster; otherwise the path ends, because next-event estimation finds such light. From then
// on, each event that spreads light is connected to the camera by a ray. All contributions are weighted against the
// camera's own paths (caustic.glsl).
//
// A path carries power, not radiance. So the BSDF is evaluated in reverse, with the outgoing direction of light as the
// view, and the cosines of interpolated normals belong to the incoming side of the light (Veach 1997, 5.3.2).
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_shuffle : require
#extension GL_KHR_shader_subgroup_vote : require

#include "pt/ways.glsl"

#include "common/finite.glsl"
#include "common/tile.glsl"
#include "pt/caustic.glsl"
#include "pt/dispatch.glsl"
#include "pt/emit.glsl"
#include "pt/film.glsl"
#include "pt/media.glsl"
#include "shared/pt.h"

layout(local_size_x = TILE_PIXELS) in;

// The state of a light path. Event 0 has not left its lamp.
struct walker {
	vec3 origin;
	vec3 direction;
	vec3 power;      // W
	float most;      // largest component of its initial power
	float lamp;      // lamp_density at its first event
	uint event;
	uvec2 media;
	uint backs;      // number of bodies in which it may still turn out to have started
	uint taken;
	bool alive;
};

// Of a lamp without an area: more than a path has events.
const uint BACKS_ANY = 0x10000u;

// A ray from a light path to the camera, and its contribution.
struct view {
	vec3 origin;
	vec3 segment;
	float t_max;     // 1; -1: no ray
	vec3 value;      // in the film's units
	uint pixel;      // pixel of the band
};

struct tally {
	uint rays;
	uint non_finite;
	uint rounds;
};

uint most_events()
{
	return EFFECT_BOUNCES ? job.depth : min(job.depth, 1u);
}

// The launch has used the first sets of samples for its point and direction. If an event used them again, it would be
// correlated with the launch.
uint sets_of(uint event)
{
	return (event + 1u) * SETS_PER_EVENT;
}

// All light paths of a half of the samples form one sequence, so that they spread evenly over lamps and casters together.
sampler_state sampler_of(uint place, uint taken)
{
	uint number = push.first_sample + taken;
	sampler_state s = sampler_make(NONE - push.first_row, number & 1u, 0u, job.seed[0], job.seed[1]);
	uint high, low, carry;
	umulExtended(number >> 1, push.light_tiles * TILE_PIXELS, high, low);
	s.index = uaddCarry(low, place, carry);
	high += carry;
	s.scramble = high > 0u ? hash_combine(s.scramble, high) : s.scramble;
	return s;
}

// The same surface, with its normals on the side of w.
surface facing(surface s, vec3 w)
{
	if (dot(s.geometric, w) < 0.0) {
		s.geometric = -s.geometric;
		s.shading = -s.shading;
		s.front = !s.front;
		s.eta = s.thin ? s.eta : 1.0 / s.eta;
	}
	return s;
}

// Handles a hit. False if the path ends.
bool meet(inout walker p, launch l, ray_hit hit, out surface s)
{
	s = surface_at(hit.id, hit.uv, p.origin, p.direction, hit.t);
	if (EFFECT_UNLIT && s.unlit)
		return false;
	if (p.event == 0u) {
		float density = caster_density[s.material];
		float cosine = abs(dot(s.geometric, p.direction));
		p.power = launch_power(l, hit.id, density, cosine, hit.t);
		p.most = max(p.power.r, max(p.power.g, p.power.b));
	}
	if (EFFECT_GLASS) {
		bool began = media_lacks(p.media, s);
		if (began && p.backs == 0u)
			return false; // its lamp is in two bodies: see caustic.glsl
		p.backs -= began ? 1u : 0u;
		p.media = media_before(p.media, s);
		p.power *= media_transmittance(p.media, hit.t);
	}
	return max(p.power.r, max(p.power.g, p.power.b)) > 0.0;
}

// The ray that connects an event to the camera.
view view_from(walker p, surface s, uvec2 beyond, sampler_state rnd)
{
	uint set = sets_of(p.event);
	view v;
	v.origin = s.position;
	v.segment = vec3(0.0, 0.0, 1.0);
	v.t_max = -1.0;
	v.value = vec3(0.0);
	v.pixel = 0u;
	vec2 u = CAMERA == CAMERA_LENS ? sample_2d(rnd, set + SET_LENS) : vec2(0.5);
	vec2 at;
	vec3 eye, direction;
	float t;
	if (!lens_image(s.position, u, at, eye, direction, t))
		return v;
	float share;
	ivec2 pixel = film_choose(at, sample_2d(rnd, set + SET_PIXEL).x, share);
	if (CAMERA == CAMERA_PANORAMA)
		pixel.x = pixel.x < 0 ? pixel.x + int(job.width) : pixel.x >= int(job.width) ? pixel.x - int(job.width) : pixel.x;
	int row = pixel.y - int(push.first_row);
	if (pixel.x < 0 || pixel.x >= int(job.width) || row < 0 || row >= int(push.band_rows))
		return v;
	surface seen = facing(s, -direction);
	vec4 f = bsdf_eval(bsdf_make(seen, direction), -p.direction);
	float cosine = abs(dot(s.geometric, direction));
	float cos_light = abs(dot(s.geometric, p.direction));
	v.value = p.power * f.xyz * (pixels_per_area(direction, t, cosine) * share / max(cos_light, 1e-30));
	bool through = dot(direction, s.geometric) > 0.0;
	if (EFFECT_GLASS)
		v.value *= media_transmittance(through ? beyond : p.media, t);
	float rivals = rivals_at(direction, t, cosine, push.light_tiles * TILE_PIXELS);
	v.value *= light_keeps(rivals_beside(rivals, f.w, cos_light), p.lamp);
	v.value /= job.film_unit * float(push.light_tiles * TILE_PIXELS);
	v.origin = s.position + seen.geometric * s.offset;
	v.segment = eye - v.origin;
	v.t_max = max(v.value.r, max(v.value.g, v.value.b)) > 0.0 ? 1.0 : -1.0;
	v.pixel = uint(row) * job.width + uint(pixel.x);
	return v;
}

// The factor of the power that continues to w from the direction `from` of incoming light; w was sampled with `from` as the
// view, with this weight and density. The cosine of an interpolated normal belongs to the incoming side of the light. A
// mirror, whatever its normal, preserves solid angles and needs no such factor; refracted light has both. `reverse` is the
// density of the camera's sampling, which goes the other way.
vec3 carried(surface s, bsdf b, vec3 from, vec3 w, vec3 weight, float pdf, out float reverse)
{
	float in_true = max(abs(dot(from, s.geometric)), 1e-6);
	float out_true = abs(dot(w, s.geometric));
	if (pdf < PDF_MIRROR) {
		vec4 f = bsdf_eval(bsdf_make(facing(s, w), -w), from);
		reverse = f.w;
		return f.xyz * (out_true / (in_true * pdf));
	}
	reverse = PDF_MIRROR;
	weight *= out_true / in_true;
	if (s.thin || dot(w, s.geometric) > 0.0)
		return weight;
	// Inside a medium of index η, radiance is η² times as large; power is not.
	return weight * (s.eta * s.eta * b.view.z / max(abs(dot(w, b.normal)), 1e-6));
}

void scatter(inout walker p, surface s, bsdf b, uvec2 beyond, sampler_state rnd, launch l, float t)
{
	uint set = sets_of(p.event);
	vec3 from = -p.direction;
	vec3 weight;
	float pdf;
	float lobe = EFFECT_GLOSSY || EFFECT_GLASS || EFFECT_CLEARCOAT ? sample_2d(rnd, set + SET_LOBE).x : 0.0;
	p.direction = bsdf_sample(b, lobe, sample_2d(rnd, set + SET_BSDF), weight, pdf);
	p.alive = max(weight.r, max(weight.g, weight.b)) > 0.0 && pdf > 0.0;
	float reverse = 0.0;
	p.power *= p.alive ? carried(s, b, from, p.direction, weight, pdf, reverse) : vec3(0.0);
	if (p.event == 0u) {
		p.alive = p.alive && casts(s.material, reverse);
		p.lamp = launch_density(l, caster_density[s.material], abs(dot(s.geometric, from)), t, reverse);
	}
	bool through = dot(p.direction, s.geometric) < 0.0;
	p.media = EFFECT_GLASS && through ? beyond : p.media;
	p.origin = s.position + (through ? -s.offset : s.offset) * s.geometric;
	p.event++;
	p.alive = p.alive && p.event < most_events();
	if (WAY_ROULETTE && p.event >= ROULETTE_FROM) {
		float stay = min(1.0, max(p.power.r, max(p.power.g, p.power.b)) / max(p.most, 1e-37));
		p.alive = p.alive && sample_2d(rnd, set + SET_CHANCE).x < stay;
		p.power /= max(stay, 1e-30);
	}
}

// One event: the ray to the camera, and the next direction.
void event_at(inout walker p, surface s, sampler_state rnd, launch l, float t, inout view v)
{
	uvec2 beyond = p.media;
	uint set = sets_of(p.event);
	if (EFFECT_GLASS)
		beyond = choose_clear(s, p.media, sample_2d(rnd, set + SET_CLEAR).x);
	bsdf b = bsdf_make(s, p.direction);
	if (p.event > 0u && !(EFFECT_GLASS && b.clear && b.glass.polished))
		v = view_from(p, s, beyond, rnd);
	scatter(p, s, b, beyond, rnd, l, t);
}

void film_take(view v, uint sample_half, float up, inout tally account)
{
	bool whole = finite(v.value) && max(v.value.r, max(v.value.g, v.value.b)) < 1e18;
	bool full = false;
	for (uint i = 0u; i < 3u && whole; i++)
		full = film_add(v.pixel, 3u * sample_half + i, v.value[i], up) || full;
	account.non_finite += whole && !full ? 0u : 1u;
}

void light_round(inout walker p, uint place, inout tally account)
{
	sampler_state rnd = sampler_of(place, p.taken);
	uint key = hash_combine(hash_combine(rnd.scramble, rnd.index), p.event);
	bool running = p.alive;
	launch l = launch_none();
	if (running && p.event == 0u) {
		l = launch_make(rnd);
		p.origin = l.origin;
		p.direction = l.direction;
		p.media = uvec2(0u);
		p.backs = l.pdf_area > 0.0 ? 1u : BACKS_ANY;
		p.alive = max(l.power.r, max(l.power.g, l.power.b)) > 0.0;
	}
	ray_hit hit;
	if (EFFECT_ALPHA_BLEND) {
		trace_chance = hash_combine(rnd.scramble, SET_ALPHA + p.event);
		trace_index = rnd.index;
	}
	bool found = trace_closest(p.origin, p.direction, p.alive ? INFINITY : -1.0, hit);
	view v;
	v.origin = p.origin;
	v.segment = vec3(0.0, 0.0, 1.0);
	v.t_max = -1.0;
	if (p.alive) {
		account.rays++;
		surface s;
		p.alive = found && meet(p, l, hit, s);
		if (p.alive)
			event_at(p, s, rnd, l, hit.t, v);
	}
	if (EFFECT_ALPHA_BLEND)
		trace_chance = ~trace_chance;
	bool shadowed = trace_any(v.origin, v.segment, v.t_max);
	if (v.t_max > 0.0) {
		account.rays++;
		if (!shadowed)
			film_take(v, (push.first_sample + p.taken) & 1u, float(key >> 8) * UNIT_24, account);
	}
}

void light_run(inout walker p, uint place, inout tally account)
{
	bool more = subgroupAny(p.alive);
	if (more) do {
		bool running = p.alive;
		light_round(p, place, account);
		if (running && !p.alive) {
			p.taken++;
			p.event = 0u;
			p.alive = p.taken < push.sample_count;
		}
		account.rounds++;
		more = account.rounds < push.round_count && subgroupAny(p.alive);
	} while (more);
	trace_cut = trace_cut || (p.alive && account.rounds < push.round_count);
}

void path_load(uint slot, out walker p)
{
	path_state s = paths[slot];
	p = walker(to_vec3(s.origin), to_vec3(s.direction), to_vec3(s.throughput), s.aim, s.pdf, s.event,
		   uvec2(s.media[0], s.media[1]), uint(s.rivals), s.taken, s.event != PATH_DONE);
}

void path_store(uint slot, walker p)
{
	paths[slot].origin = float[3](p.origin.x, p.origin.y, p.origin.z);
	paths[slot].event = p.alive ? p.event : PATH_DONE;
	paths[slot].direction = float[3](p.direction.x, p.direction.y, p.direction.z);
	paths[slot].pdf = p.lamp;
	paths[slot].throughput = float[3](p.power.r, p.power.g, p.power.b);
	paths[slot].taken = p.taken;
	paths[slot].media = uint[2](p.media.x, p.media.y);
	paths[slot].aim = p.most;
	paths[slot].rivals = float(p.backs);
}

void main()
{
	uint slot = gl_WorkGroupID.x * TILE_PIXELS + gl_LocalInvocationIndex;
	uint band_first = push.first_row / TILE_SIDE * job.tiles_x;
	uint place = (push.first_tile - band_first + gl_WorkGroupID.x) * TILE_PIXELS + gl_LocalInvocationIndex;
	walker p;
	p.taken = 0u;
	p.event = 0u;
	p.backs = 0u;
	p.alive = true;
	if (RESUMED && push.resumes != 0u)
		path_load(slot, p);
	p.alive = p.alive && gl_WorkGroupID.x < push.tile_count;
	bool had_work = p.alive;
	tally account = tally(0u, 0u, 0u);
	light_run(p, place, account);
	if (!had_work)
		return;
	count_work(account.rays, account.non_finite, account.rounds);
	if (RESUMED)
		path_store(slot, p);
}
