// Sample points: Owen-scrambled Sobol' points in two dimensions, padded.
//
// Each decision of a path takes a two-dimensional point from a set of its own. A set is the first two dimensions of Sobol'
// 1967, its index shuffled and its digits scrambled by hashes of (pixel, half, set, seed): "Practical Hash-based Owen
// Scrambling", Burley 2020 (JCGT 9-4). The two halves of a frame's samples use different hashes, so they are independent,
// and the difference of their means estimates the error of the mean of both.
//
// The alternative is one hash for a block of pixels, which take consecutive runs of one sequence in Morton order (Ahmed and
// Wonka 2020, "Screen-space blue-noise diffusion of Monte Carlo sampling error via hierarchical ordering of pixels"). A run
// is as good as points of the pixel's own. In addition, the runs of neighbouring pixels together are such a set, so that
// their errors cancel where the picture is filtered or seen from afar.
#ifndef COMMON_SAMPLING_GLSL
#define COMMON_SAMPLING_GLSL

// The sets of a path. Each decision has a fixed number, so that leaving out an effect does not change the samples of the
// others.
const uint SET_PIXEL = 0u;         // position within the pixel
const uint SETS_PER_EVENT = 8u;     // some are unused
const uint SET_PICK = 1u;          // which light; to be added to event × SETS_PER_EVENT, as all below
const uint SET_LIGHT = 2u;         // position on the light
const uint SET_BSDF = 3u;          // the next direction
const uint SET_CHANCE = 4u;        // x: whether to go on; y: emissive triangles or punctual lights

const uint SET_LOBE = 5u;          // x: which lobe of the BSDF
const uint SET_CLEAR = 6u;         // x: whether a partly transparent surface is hit or passed

const uint SET_LENS = 7u;          // position on the lens; first event only

const uint SET_CELL = 0x40000000u;  // which cell of an emissive triangle; to be added to the event's first set

const uint SET_ALPHA = 0x80000000u; // seeds the sets of blended surfaces, one a triangle; to be added to event

const float UNIT_24 = 5.9604644775390625e-08;   // 2⁻²⁴

#ifndef SAMPLES_INDEPENDENT
#define SAMPLES_INDEPENDENT false
#endif

struct sampler_state {
	uint index;       // index of the sample in its half
	uint scramble;    // hash of pixel, half and seed
};

// A mix of 32 bits in which every input bit affects every output bit: lowbias32, Wellons 2018.
uint hash(uint x)
{
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	x ^= x >> 16;
	return x;
}

uint hash_combine(uint seed, uint v)
{
	return hash(seed ^ (v * 0x9e3779b9u + 0x7f4a7c15u));
}

// A nested uniform scramble of a bit-reversed number: Laine and Karras 2011 with Burley's constants. Each step lets a bit
// depend on lower bits only.
uint scramble_reversed(uint x, uint seed)
{
	x += seed;
	x ^= x * 0x6c50b47cu;
	x ^= x * 0xb82f1e52u;
	x ^= x * 0xc7afe638u;
	x ^= x * 0x8d22f6e6u;
	return x;
}

// The second Sobol' dimension of an index, bit-reversed. Its generator matrix is Pascal's triangle mod 2, which is a
// Kronecker power of ((1 1)(0 1)), so five butterflies apply it.
uint sobol1_reversed(uint i)
{
	i ^= (i & 0xaaaaaaaau) >> 1;
	i ^= (i & 0xccccccccu) >> 2;
	i ^= (i & 0xf0f0f0f0u) >> 4;
	i ^= (i & 0xff00ff00u) >> 8;
	i ^= (i & 0xffff0000u) >> 16;
	return i;
}

sampler_state sampler_make(uint pixel, uint sample_half, uint index, uint seed_lo, uint seed_hi)
{
	sampler_state s;
	s.index = index;
	s.scramble = hash_combine(hash_combine(hash_combine(hash(seed_lo), seed_hi), pixel), sample_half);
	return s;
}

// Interleaves the bits of x and y; the lowest bit is x's.
uint morton(uvec2 p)
{
	p = (p | p << 8) & 0x00ff00ffu;
	p = (p | p << 4) & 0x0f0f0f0fu;
	p = (p | p << 2) & 0x33333333u;
	p = (p | p << 1) & 0x55555555u;
	return p.x | p.y << 1;
}

// x: where a pixel's run of 1 << bits samples begins in the sequence of its block. y: the block's number, which seeds the
// scramble as the pixel's number does otherwise. A block is as large as a 32-bit index allows.
uvec2 sampler_run(uvec2 pixel, uint bits)
{
	uint levels = min((32u - bits) / 2u, 16u);
	uvec2 within = pixel & ((1u << levels) - 1u);
	uvec2 block = pixel >> levels;
	return uvec2(morton(within) << bits, block.y << 16 | block.x);
}

// 32 random bits for each of two dimensions.
uvec2 sample_bits(sampler_state s, uint set)
{
	uint h = hash_combine(s.scramble, set);
	if (SAMPLES_INDEPENDENT) {
		uint own = hash_combine(h, s.index);
		return uvec2(hash(own ^ 0x68bc21ebu), hash(own ^ 0x02e5be93u));
	}
	// The shuffle is a nested uniform scramble of the index, so it keeps every aligned block of 2ⁿ indices together.
	uint i = bitfieldReverse(scramble_reversed(bitfieldReverse(s.index), h));
	uint x = scramble_reversed(i, hash(h ^ 0x68bc21ebu));
	uint y = scramble_reversed(sobol1_reversed(i), hash(h ^ 0x02e5be93u));
	return bitfieldReverse(uvec2(x, y));
}

// A point in [0, 1)²: 24 bits a coordinate, so that 1 is never reached.
vec2 sample_2d(sampler_state s, uint set)
{
	return vec2(sample_bits(s, set) >> 8) * UNIT_24;
}

// Maps the unit square to the unit disc, uniformly: the concentric map (Shirley and Chiu 1997).
vec2 concentric_disc(vec2 u)
{
	vec2 a = 2.0 * u - 1.0;
	bool wide = abs(a.x) > abs(a.y);
	float r = wide ? a.x : a.y;
	float other = wide ? a.y : a.x;
	float phi = r != 0.0 ? 0.78539816339744831 * (other / r) : 0.0;
	float c = cos(phi);
	float s = sin(phi);
	return r * (wide ? vec2(c, s) : vec2(s, c));
}

// Cosine-distributed direction about +Z, by projecting the disc upwards. pdf = cos θ / π.
vec3 cosine_hemisphere(vec2 u)
{
	vec2 disc = concentric_disc(u);
	return vec3(disc, sqrt(max(0.0, 1.0 - dot(disc, disc))));
}

// Uniform direction in the hemisphere about +Z. pdf = 1 / 2π.
vec3 uniform_hemisphere(vec2 u)
{
	float r = sqrt(max(0.0, 1.0 - u.x * u.x));
	float phi = 6.28318530717958648 * u.y;
	return vec3(r * cos(phi), r * sin(phi), u.x);
}

// Two unit vectors x and y that form a right-handed frame with n: Duff et al. 2017 (JCGT 6-1).
void frame_make(vec3 n, out vec3 x, out vec3 y)
{
	float s = n.z >= 0.0 ? 1.0 : -1.0;
	float a = -1.0 / (s + n.z);
	float b = n.x * n.y * a;
	x = vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x);
	y = vec3(b, s + n.y * n.y * a, -n.y);
}

// A normal, or if the view is behind it, the normal tilted towards the view until that is barely in front.
vec3 normal_in_front(vec3 normal, vec3 view)
{
	float c = dot(normal, view);
	return c < 1e-3 ? normalize(normal + (1e-3 - c) * view) : normal;
}

// Barycentrics of corners 1 and 2, uniform over the triangle. Near inputs give near points: Heitz 2019.
vec2 sample_triangle(vec2 u)
{
	if (u.y > u.x) {
		u.x *= 0.5;
		u.y -= u.x;
	} else {
		u.y *= 0.5;
		u.x -= u.y;
	}
	return u;
}

// Power heuristic with β = 2 (Veach 1997, 9.2.4): the weight of a technique of density 1 where the other's density is r.
float power_weight(float r)
{
	return 1.0 / (1.0 + r * r);
}

#endif
