// Affine maps in double precision, as node hierarchies compose them. Any thread. No function fails except where noted.
#ifndef CANDIL_SCENE_TRANSFORM_H
#define CANDIL_SCENE_TRANSFORM_H

#include <stdbool.h>

// The columns are the images of the axes, then of the origin: p' = c[0]·x + c[1]·y + c[2]·z + c[3].
struct transform {
	double c[4][3];
};

// A map as glTF animates it: scale, then rotate, then translate. The quaternion is x, y, z, w and of unit length.
struct transform_parts {
	double translation[3];
	double rotation[4];
	double scale[3];
};

extern const struct transform transform_identity;
extern const struct transform_parts transform_no_parts;

// The product parent · local, which applies `local` first.
struct transform transform_compose(const struct transform *parent, const struct transform *local);

// The map translation · rotation · scale. The quaternion is normalised first; one that has no length or is not finite means
// no rotation.
struct transform transform_of_parts(const struct transform_parts *parts);

// The parts of a map without shear. With shear, the nearest such map by Gram-Schmidt on its columns. A reflection becomes a
// negative x scale. A column of length zero gives a scale of zero and no rotation.
struct transform_parts transform_to_parts(const struct transform *map);

// Invert a map. False, and *out unchanged, if the map flattens space: its determinant is below 1e-12 of the product of its
// columns' lengths, or not a normal number.
bool transform_invert(const struct transform *map, struct transform *out);

bool transform_is_finite(const struct transform *map);
bool transform_is_same(const struct transform *a, const struct transform *b); // bit for bit, except that -0 equals 0

void transform_point(const struct transform *map, const double in[3], double out[3]);

// The map of normals. Normals are transformed by the inverse transpose. Its cofactors need no division, and differ from it
// only by a factor with the determinant's sign.
struct transform_normals {
	double c[3][3];
	double determinant;
};

struct transform_normals transform_normals_of(const struct transform *map);

// Transform a normal of any length. The result's largest component is ±1, so that it fits a float whatever the scale. Zero
// if the map leaves no direction.
void transform_normal(const struct transform_normals *map, const double in[3], float out[3]);

// Transform a tangent. in[3] is the sign of its bitangent. The tangent is transformed by the map itself, and a reflection
// reverses the sign. All zero if the map leaves no direction or in[3] is zero.
void transform_tangent(const struct transform *map, const struct transform_normals *normals, const double in[4],
		       float out[4]);

// Normalise in place. False for a vector without a direction.
bool transform_normalize(double v[3]);

#endif
