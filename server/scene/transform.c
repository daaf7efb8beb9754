#include "server/scene/transform.h"

#include <float.h>
#include <math.h>

#include "server/base/vec3.h"

const struct transform transform_identity = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
const struct transform_parts transform_no_parts = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};

struct transform transform_compose(const struct transform *parent, const struct transform *local)
{
	struct transform out;
	for (int column = 0; column < 4; column++)
		for (int row = 0; row < 3; row++) {
			double sum = column == 3 ? parent->c[3][row] : 0.0;
			for (int k = 0; k < 3; k++)
				sum += parent->c[k][row] * local->c[column][k];
			out.c[column][row] = sum;
		}
	return out;
}

static void turn(struct transform *t, const double q[4])
{
	const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	if (!(length > 0) || !isfinite(length))
		return;
	const double x = q[0] / length, y = q[1] / length, z = q[2] / length, w = q[3] / length;
	const double r[3][3] = {
	    {1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
	    {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
	    {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)},
	};
	for (int column = 0; column < 3; column++)
		for (int row = 0; row < 3; row++)
			t->c[column][row] = r[column][row];
}

struct transform transform_of_parts(const struct transform_parts *parts)
{
	struct transform t = transform_identity;
	turn(&t, parts->rotation);
	for (int column = 0; column < 3; column++)
		for (int row = 0; row < 3; row++)
			t.c[column][row] *= parts->scale[column];
	for (int row = 0; row < 3; row++)
		t.c[3][row] = parts->translation[row];
	return t;
}

// Shepperd's method: it starts from the largest of the four components, so that it never divides by a small number.
static void quaternion_of(const double c[3][3], double q[4])
{
	const double trace = c[0][0] + c[1][1] + c[2][2];
	int i = 0;
	if (trace > 0) {
		const double s = 2 * sqrt(1 + trace);
		q[3] = 0.25 * s;
		q[0] = (c[1][2] - c[2][1]) / s;
		q[1] = (c[2][0] - c[0][2]) / s;
		q[2] = (c[0][1] - c[1][0]) / s;
		return;
	}
	if (c[1][1] > c[i][i])
		i = 1;
	if (c[2][2] > c[i][i])
		i = 2;
	const int j = (i + 1) % 3, k = (i + 2) % 3;
	const double s = 2 * sqrt(fmax(1 + c[i][i] - c[j][j] - c[k][k], 0));
	q[i] = 0.25 * s;
	q[j] = (c[i][j] + c[j][i]) / s;
	q[k] = (c[i][k] + c[k][i]) / s;
	q[3] = (c[j][k] - c[k][j]) / s;
}

struct transform_parts transform_to_parts(const struct transform *map)
{
	struct transform_parts out = transform_no_parts;
	double axis[3][3];
	for (int i = 0; i < 3; i++) {
		out.translation[i] = map->c[3][i];
		for (int row = 0; row < 3; row++)
			axis[i][row] = map->c[i][row];
		out.scale[i] = sqrt(vec3_dot(map->c[i], map->c[i]));
	}
	double across[3];
	vec3_cross(axis[1], axis[2], across);
	if (vec3_dot(axis[0], across) < 0) {
		out.scale[0] = -out.scale[0];
		for (int row = 0; row < 3; row++)
			axis[0][row] = -axis[0][row];
	}
	if (!transform_normalize(axis[0]))
		return out;
	const double along = vec3_dot(axis[0], axis[1]);
	for (int row = 0; row < 3; row++)
		axis[1][row] -= along * axis[0][row];
	if (!transform_normalize(axis[1]))
		return out;
	vec3_cross(axis[0], axis[1], axis[2]);
	quaternion_of(axis, out.rotation);
	return out;
}

struct transform_normals transform_normals_of(const struct transform *map)
{
	struct transform_normals m;
	for (int i = 0; i < 3; i++)
		vec3_cross(map->c[(i + 1) % 3], map->c[(i + 2) % 3], m.c[i]);
	m.determinant = vec3_dot(map->c[0], m.c[0]);
	return m;
}

bool transform_invert(const struct transform *map, struct transform *out)
{
	const struct transform_normals n = transform_normals_of(map);
	const double size = sqrt(vec3_dot(map->c[0], map->c[0])) * sqrt(vec3_dot(map->c[1], map->c[1])) *
			    sqrt(vec3_dot(map->c[2], map->c[2]));
	if (!(fabs(n.determinant) > 1e-12 * size) || !(fabs(n.determinant) >= DBL_MIN) || !isfinite(n.determinant))
		return false;
	struct transform inverse;
	for (int column = 0; column < 3; column++)
		for (int row = 0; row < 3; row++)
			inverse.c[column][row] = n.c[row][column] / n.determinant;
	for (int row = 0; row < 3; row++)
		inverse.c[3][row] = -(inverse.c[0][row] * map->c[3][0] + inverse.c[1][row] * map->c[3][1] +
				      inverse.c[2][row] * map->c[3][2]);
	if (!transform_is_finite(&inverse))
		return false;
	*out = inverse;
	return true;
}

bool transform_is_finite(const struct transform *map)
{
	for (int i = 0; i < 12; i++)
		if (!isfinite(map->c[i / 3][i % 3]))
			return false;
	return true;
}

bool transform_is_same(const struct transform *a, const struct transform *b)
{
	for (int i = 0; i < 12; i++)
		if (!(a->c[i / 3][i % 3] <= b->c[i / 3][i % 3] && a->c[i / 3][i % 3] >= b->c[i / 3][i % 3]))
			return false;
	return true;
}

void transform_point(const struct transform *map, const double in[3], double out[3])
{
	double p[3];
	for (int row = 0; row < 3; row++)
		p[row] = map->c[0][row] * in[0] + map->c[1][row] * in[1] + map->c[2][row] * in[2] + map->c[3][row];
	for (int row = 0; row < 3; row++)
		out[row] = p[row];
}

void transform_normal(const struct transform_normals *map, const double in[3], float out[3])
{
	double v[3], length = 0;
	for (int row = 0; row < 3; row++) {
		v[row] = map->c[0][row] * in[0] + map->c[1][row] * in[1] + map->c[2][row] * in[2];
		length = fmax(length, fabs(v[row]));
	}
	for (int row = 0; row < 3; row++)
		out[row] = length > 0 && isfinite(length)
			       ? (float)(map->determinant < 0 ? -v[row] / length : v[row] / length)
			       : 0.0f;
}

void transform_tangent(const struct transform *map, const struct transform_normals *normals, const double in[4],
		       float out[4])
{
	double v[3], length = 0;
	for (int row = 0; row < 3; row++) {
		v[row] = map->c[0][row] * in[0] + map->c[1][row] * in[1] + map->c[2][row] * in[2];
		length = fmax(length, fabs(v[row]));
	}
	const bool usable = length > 0 && isfinite(length) && (in[3] > 0 || in[3] < 0);
	for (int row = 0; row < 3; row++)
		out[row] = usable ? (float)(v[row] / length) : 0.0f;
	// A mirror reverses the handedness of normal, tangent and bitangent.
	out[3] = !usable ? 0.0f : (in[3] > 0) == (normals->determinant >= 0) ? 1.0f : -1.0f;
}

bool transform_normalize(double v[3])
{
	const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
	if (!(largest > 0) || !isfinite(largest))
		return false;
	for (int i = 0; i < 3; i++)
		v[i] /= largest;
	const double length = sqrt(vec3_dot(v, v));
	for (int i = 0; i < 3; i++)
		v[i] /= length;
	return true;
}
