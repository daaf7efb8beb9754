// Unit vectors in 32 bits: the unfolded octahedron (Cigolle et al. 2014, "A survey of efficient representations for
// independent unit vectors").
#ifndef VOXEL_OCTAHEDRAL_GLSL
#define VOXEL_OCTAHEDRAL_GLSL

vec2 octahedral_signs(vec2 v)
{
	return vec2(v.x < 0.0 ? -1.0 : 1.0, v.y < 0.0 ? -1.0 : 1.0);
}

uint octahedral_pack(vec3 n)
{
	vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
	p = n.z < 0.0 ? (1.0 - abs(p.yx)) * octahedral_signs(p) : p;
	return packSnorm2x16(p);
}

vec3 octahedral_unpack(uint bits)
{
	vec2 p = unpackSnorm2x16(bits);
	float z = 1.0 - abs(p.x) - abs(p.y);
	p = z < 0.0 ? (1.0 - abs(p.yx)) * octahedral_signs(p) : p;
	return normalize(vec3(p, z));
}

#endif
