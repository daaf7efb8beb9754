// Affine maps in double, as node hierarchies compose them. Any thread; no failure but where said.
#ifndef CANDIL_SCENE_TRANSFORM_H
#define CANDIL_SCENE_TRANSFORM_H

#include <stdbool.h>

// Columns: the images of the axes, then of the origin. p' = c[0]·x + c[1]·y + c[2]·z + c[3].
struct transform {
	double c[4][3];
};

// A map as glTF animates it: scale, then turn, then move. The quaternion is x, y, z, w and of unit length.
struct transform_parts {
	double translation[3];
	double rotation[4];
	double scale[3];
};

extern const struct transform transform_identity;
extern const struct transform_parts transform_no_parts;

// parent · local: `local` first.
struct transform transform_compose(const struct transform *parent, const struct transform *local);

// translation · rotation · scale. A quaternion is made unit first; one without a length or not finite turns nothing.
struct transform transform_of_parts(const struct transform_parts *parts);

// The parts of a map without shear; with one, the nearest by Gram-Schmidt on its columns. A mirror is a negative x scale.
// A column of length zero gives a scale of zero and no turn.
struct transform_parts transform_to_parts(const struct transform *map);

// False, and *out untouched, where the map flattens space: its determinant is below 1e-12 of the product of its columns'
// lengths, or not a normal number.
bool transform_invert(const struct transform *map, struct transform *out);

bool transform_is_finite(const struct transform *map);
bool transform_is_same(const struct transform *a, const struct transform *b); // bit for bit, -0 being 0

void transform_point(const struct transform *map, const double in[3], double out[3]);

// How directions go. Normals go by the inverse transpose; its cofactors do without a division, up to a factor that has the
// determinant's sign.
struct transform_normals {
	double c[3][3];
	double determinant;
};

struct transform_normals transform_normals_of(const struct transform *map);

// A normal, any length, to one whose largest component is ±1, so that a float holds it whatever the scale. Zero where it
// comes to nothing.
void transform_normal(const struct transform_normals *map, const double in[3], float out[3]);

// A direction along a surface, with a sign in [3] that says which way its bitangent goes: by the map itself, the sign turned
// by a mirror. All zero where it comes to nothing or the sign is none.
void transform_tangent(const struct transform *map, const struct transform_normals *normals, const double in[4],
		       float out[4]);

// Unit length, in place. False for a vector without a direction.
bool transform_normalize(double v[3]);

#endif
