// What passes over the voxels' entries share.
#ifndef VCT_ENTRY_GLSL
#define VCT_ENTRY_GLSL

// Irradiance as an entry keeps it: finite, and nothing where it is no number, by comparisons that a NaN fails.
vec3 entry_bounded(vec3 e)
{
	return vec3(e.r > 0.0 ? min(e.r, 1e30) : 0.0, e.g > 0.0 ? min(e.g, 1e30) : 0.0, e.b > 0.0 ? min(e.b, 1e30) : 0.0);
}

// The voxel of that number in a grid of so many.
uvec3 entry_voxel(uint number, uvec3 sides)
{
	return uvec3(number % sides.x, number / sides.x % sides.y, number / sides.x / sides.y);
}

// A number of 0 to 3 that differs among the four voxels of any two by two that lie in a plane across an axis.
uint entry_group(uvec3 voxel)
{
	return ((voxel.x ^ voxel.z) & 1u) | ((voxel.y ^ voxel.z) & 1u) << 1;
}

#endif
