// The BSDF by itself, seen from one direction: directions that it samples, or its values for given ones.
#version 460
#extension GL_GOOGLE_include_directive : require
#define BIND_GGX_TABLE 0
#include "common/bsdf.glsl"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push {
	float cosine;      // of the view to the surface
	float roughness;
	float f0;
	float diffuse;
	float tilt;        // of the shading normal towards +x, radians
	uint seed;
	uint mode;         // 0: sample; 1: evaluate the grid of directions; 2: both ways between two random directions
	uint side;         // mode 1: directions are side × side, (z, phi) evenly
	float eta;         // 0: opaque; below 0: a thin wall of −eta; else a clear solid's
	float matte;       // diffuse roughness
	float coat;        // how much of it there is
	float coat_roughness;
	float coat_tilt;   // of its normal
} push;
layout(std430, set = 0, binding = 1) writeonly buffer Out {
	vec4 results[];    // mode 0: direction and pdf, then weight; mode 1: value and pdf; mode 2: diffuse there and back, facets likewise
};

void main()
{
	uint i = gl_GlobalInvocationID.x;
	surface s;
	s.position = vec3(0.0);
	s.geometric = vec3(0.0, 0.0, 1.0);
	s.shading = vec3(sin(push.tilt), 0.0, cos(push.tilt));
	s.albedo = vec3(push.diffuse);
	s.f0 = vec3(push.f0);
	s.f90 = vec3(push.f0 > 0.0 ? 1.0 : 0.0);
	s.roughness = push.roughness;
	s.clear = push.eta != 0.0;
	s.thin = push.eta < 0.0;
	s.eta = abs(push.eta);
	s.base = vec3(push.diffuse);
	s.diffuse_roughness = push.matte;
	s.coat = push.coat;
	s.coat_roughness = push.coat_roughness;
	s.coat_normal = vec3(sin(push.coat_tilt), 0.0, cos(push.coat_tilt));
	vec3 view = vec3(sqrt(1.0 - push.cosine * push.cosine), 0.0, push.cosine);
	bsdf b = bsdf_make(s, -view);
	if (push.mode == 0u) {
		sampler_state rnd = sampler_make(i, 0u, 0u, push.seed, 0u);
		vec3 weight;
		float pdf;
		vec3 w = bsdf_sample(b, sample_2d(rnd, 0u).x, sample_2d(rnd, 1u), weight, pdf);
		results[2u * i] = vec4(w, pdf);
		results[2u * i + 1u] = vec4(weight, 0.0);
	} else if (push.mode == 2u) {
		s.shading = s.geometric;
		s.coat_normal = s.geometric;
		sampler_state rnd = sampler_make(i, 0u, 0u, push.seed, 0u);
		vec3 v = cosine_hemisphere(sample_2d(rnd, 0u));
		vec3 l = cosine_hemisphere(sample_2d(rnd, 1u));
		bsdf there = bsdf_make(s, -v);
		bsdf back = bsdf_make(s, -l);
		vec3 in_there = into_frame(there, l);
		vec3 in_back = into_frame(back, v);
		// By the cosine, which is the light's, and not the BSDF's.
		float out_there = there.film.share > 0.0 ? there.film.passed : 1.0;
		float out_back = back.film.share > 0.0 ? back.film.passed : 1.0;
		results[i] = vec4(out_there * diffuse_lobe(there, in_there).r / in_there.z,
				  out_back * diffuse_lobe(back, in_back).r / in_back.z,
				  ggx_eval(there.view, in_there, there.gloss.alpha, s.f0, s.f90).r / in_there.z,
				  ggx_eval(back.view, in_back, back.gloss.alpha, s.f0, s.f90).r / in_back.z);
	} else {
		float z = (float(i / push.side) + 0.5) / float(push.side);
		z = s.clear ? 2.0 * z - 1.0 : z;
		float phi = 2.0 * PI * (float(i % push.side) + 0.5) / float(push.side);
		float r = sqrt(1.0 - z * z);
		results[i] = bsdf_eval(b, vec3(r * cos(phi), r * sin(phi), z));
	}
}
