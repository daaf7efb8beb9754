// Form factors of many polygons: closed bodies whose rows are 1, balls in balls, discs; an element's; and what sees nothing,
// or is no polygon.
#include "tests/unit/form_factor_check.h"

#include <string.h>

#include "server/base/angle.h"

#define FACES_MOST 96u

// ---- closed bodies ----------------------------------------------------------------------------------------------------

struct faces {
	struct form_polygon list[FACES_MOST];
	uint32_t count;
};

static void add_triangle(struct faces *f, const double *a, const double *b, const double *c, double scale)
{
	const double *v[3] = {a, b, c};
	double normal[3], u[3], w[3];
	struct form_polygon *p = &f->list[f->count++];
	p->corners = 3;
	for (int k = 0; k < 3; k++) {
		u[k] = b[k] - a[k];
		w[k] = c[k] - a[k];
	}
	vec3_cross(u, w, normal);
	// Bodies are about the origin. With a scale below zero faces look inwards.
	const bool turn = (vec3_dot(normal, a) < 0) != (scale < 0);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			p->at[i][k] = fabs(scale) * v[turn ? 2 - i : i][k];
}

// A body all of whose faces are triangles with sides of one length, in a ball of 1; its faces cut in four that bulge to the
// ball, if it is to be `fine`.
static void add_body(struct faces *f, const double (*at)[3], uint32_t corners, double side, bool fine, double scale)
{
	f->count = 0;
	for (uint32_t i = 0; i < corners; i++) {
		for (uint32_t j = i + 1; j < corners; j++) {
			for (uint32_t k = j + 1; k < corners; k++) {
				const double *v[3] = {at[i], at[j], at[k]};
				double m[3][3];
				bool face = true;
				for (int e = 0; e < 3; e++) {
					face &= fabs(distance(v[e], v[(e + 1) % 3]) - side) < 1e-9;
					for (int c = 0; c < 3; c++)
						m[e][c] = v[e][c] + v[(e + 1) % 3][c];
					vec3_normalize(m[e]);
				}
				if (face && !fine)
					add_triangle(f, v[0], v[1], v[2], scale);
				for (int e = 0; e < 3 && face && fine; e++)
					add_triangle(f, v[e], m[e], m[(e + 2) % 3], scale);
				if (face && fine)
					add_triangle(f, m[0], m[1], m[2], scale);
			}
		}
	}
}

static void icosahedron(struct faces *f, bool fine, double scale)
{
	const double golden = (1 + sqrt(5)) / 2, unit = 1 / sqrt(1 + golden * golden);
	double at[12][3];
	for (int i = 0; i < 12; i++) {
		const int axis = i / 4;
		at[i][axis] = 0;
		at[i][(axis + 1) % 3] = i & 1 ? unit : -unit;
		at[i][(axis + 2) % 3] = (i & 2 ? golden : -golden) * unit;
	}
	add_body(f, (const double(*)[3])at, 12, 2 * unit, fine, scale);
	assert_int_equal(f->count, fine ? 80 : 20);
}

// A box that one looks at from within, each face cut in n by n.
static void box(struct faces *f, const double size[3], uint32_t n)
{
	f->count = 0;
	for (uint32_t side = 0; side < 6; side++) {
		const uint32_t axis = side / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
		for (uint32_t i = 0; i < n * n; i++) {
			struct form_polygon *p = &f->list[f->count++];
			p->corners = 4;
			for (uint32_t k = 0; k < 4; k++) {
				const uint32_t corner = side % 2 ? 3 - k : k;
				p->at[k][axis] = side % 2 ? size[axis] : 0;
				p->at[k][u] = size[u] * (i % n + (corner == 1 || corner == 2)) / n;
				p->at[k][v] = size[v] * (i / n + (corner > 1)) / n;
			}
		}
	}
}

static void check_rows(const char *name, const struct faces *f)
{
	for (uint32_t i = 0; i < f->count; i++) {
		double row = 0;
		for (uint32_t j = 0; j < f->count; j++)
			row += exchange(&f->list[i], &f->list[j]);
		check_close(name, row / form_factor_area(&f->list[i]), 1, 1e-7);
	}
}

static void rows_of_closed_bodies_are_1(void **state)
{
	(void)state;
	static const double cube[3] = {1, 1, 1}, hall[3] = {1, 0.01, 1000}, flat[3] = {1, 1, 1e-4};
	static const double tetrahedron[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
	struct faces f;
	for (uint32_t n = 1; n <= 4; n++) {
		box(&f, cube, n);
		check_rows("cube", &f);
	}
	box(&f, hall, 2);
	check_rows("hall", &f);
	box(&f, flat, 2);
	check_rows("flat", &f);
	add_body(&f, tetrahedron, 4, sqrt(8), false, -1);
	assert_int_equal(f.count, 4);
	check_rows("tetrahedron", &f);
	icosahedron(&f, false, -1);
	check_rows("icosahedron", &f);
	icosahedron(&f, true, -1);
	check_rows("ball of 80 faces", &f);
}

// A convex body within another: each face sees the outer body alone, which is closed. The areas of alike bodies of half the
// size are a quarter.
static void a_ball_in_a_ball_is_1_and_a_quarter(void **state)
{
	(void)state;
	for (int fine = 0; fine < 2; fine++) {
		struct faces inner, outer;
		double all = 0, area = 0;
		icosahedron(&inner, fine, 0.5);
		icosahedron(&outer, fine, -1);
		for (uint32_t i = 0; i < inner.count; i++) {
			double row = 0;
			for (uint32_t j = 0; j < outer.count; j++)
				row += exchange(&inner.list[i], &outer.list[j]);
			check_close("inner", row / form_factor_area(&inner.list[i]), 1, 1e-7);
			all += row;
			area += form_factor_area(&outer.list[i]);
		}
		check_close("outer", all / area, 0.25, 1e-7);
	}
}

// A sector of a regular polygon with so many sides, in a circle of 1.
static struct form_polygon sector(uint32_t sides, uint32_t i, double height, bool down)
{
	struct form_polygon p = {{{0, 0, height}}, 3};
	for (uint32_t k = 0; k < 2; k++) {
		const double angle = 2 * PI * (i + (k != down)) / sides;
		p.at[1 + k][0] = cos(angle);
		p.at[1 + k][1] = sin(angle);
		p.at[1 + k][2] = height;
	}
	return p;
}

// The error of polygons in place of discs is one of powers of 1 / sides², the first three of which are taken off.
static double of_circle(const double by_sides[4])
{
	double f[4];
	memcpy(f, by_sides, sizeof f);
	for (int power = 1; power < 4; power++)
		for (int i = 0; i < 4 - power; i++)
			f[i] = f[i + 1] + (f[i + 1] - f[i]) / (pow(4, power) - 1);
	return f[0];
}

static void polygons_become_discs(void **state)
{
	(void)state;
	const double disc = (3 - sqrt(5)) / 2;
	const double at[3] = {0, 0, 0}, up[3] = {0, 0, 1};
	double f[4], seen[4];
	for (uint32_t k = 0; k < 4; k++) {
		const uint32_t sides = 8u << k;
		const struct form_polygon one = sector(sides, 0, 0, false);
		f[k] = seen[k] = 0;
		for (uint32_t i = 0; i < sides; i++) {
			const struct form_polygon other = sector(sides, i, 1, true);
			f[k] += exchange(&one, &other) / form_factor_area(&one);
			seen[k] += form_factor_at(at, up, &other);
		}
	}
	check_close("order", (f[2] - disc) / (f[3] - disc), 4, 0.02);
	check_close("discs", of_circle(f), disc, 1e-7);
	check_close("a disc from below", of_circle(seen), 0.5, 1e-7);
}

static void six_corners_are_a_fan_of_triangles(void **state)
{
	(void)state;
	struct form_polygon a = {.corners = 6}, b = {.corners = 6};
	double fan = 0;
	for (uint32_t i = 0; i < 6; i++) {
		const struct form_polygon p = sector(6, i, 0, false), q = sector(6, 5 - i, 0.3, true);
		memcpy(a.at[i], p.at[1], sizeof a.at[i]);
		memcpy(b.at[i], q.at[1], sizeof b.at[i]);
		for (uint32_t k = 0; k < 6; k++) {
			const struct form_polygon other = sector(6, k, 0.3, true);
			fan += exchange(&p, &other);
		}
	}
	check_close("hexagons", exchange(&a, &b), fan, 1e-12);
}

// ---- an element -------------------------------------------------------------------------------------------------------

static void an_element_sees_what_closed_forms_say(void **state)
{
	(void)state;
	const double o[3] = {0, 0, 0}, up[3] = {0, 0, 1}, down[3] = {0, 0, -1}, side[3] = {1, 0, 0};
	static const double sizes[][3] = {{1, 1, 1}, {2, 0.3, 1}, {0.1, 5, 0.7}, {1e3, 1e3, 1e-3}, {1e-2, 1e-2, 3}};
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		const double a = sizes[i][0], b = sizes[i][1], h = sizes[i][2];
		// Howell's B-3: a rectangle parallel to the element, one corner above it.
		const struct form_polygon lid = {{{0, 0, h}, {0, b, h}, {a, b, h}, {a, 0, h}}, 4};
		const double p = sqrt(a * a + h * h), q = sqrt(b * b + h * h);
		const double lies = (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * PI);
		check_close("parallel", form_factor_at(o, up, &lid), lies, 1e-11);
		// B-4: one at right angles, at a distance h, from the plane of the element up.
		const struct form_polygon wall = {{{h, 0, 0}, {h, 0, a}, {h, b, a}, {h, b, 0}}, 4};
		const double stands = (atan(b / h) - h / p * atan(b / p)) / (2 * PI);
		check_close("upright", form_factor_at(o, up, &wall), stands, 1e-9);
		check_close("upright and faced", form_factor_at(o, side, &wall),
			    (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * PI), 1e-11);
		// The half that is below the horizon is not seen; nor is what is all below. A back is told by its sign.
		const struct form_polygon sunk = {{{h, 0, -2 * a}, {h, 0, a}, {h, b, a}, {h, b, -2 * a}}, 4};
		const struct form_polygon back = {{{h, b, 0}, {h, b, a}, {h, 0, a}, {h, 0, 0}}, 4};
		check_close("half sunk", form_factor_at(o, up, &sunk), stands, 1e-9);
		check_close("its back", form_factor_at(o, up, &back), -stands, 1e-9);
		assert_true(form_factor_at(o, down, &wall) == 0 && form_factor_at(o, down, &lid) == 0);
	}
}

// ---- nothing, and worse -----------------------------------------------------------------------------------------------

static void check_nothing(const struct form_polygon *a, const struct form_polygon *b)
{
	double error;
	assert_true(form_factor_exchange(a, b, 0, &error) == 0 && error == 0);
	assert_true(form_factor_exchange(b, a, 0, &error) == 0 && error == 0);
}

static void what_sees_nothing_has_exactly_0(void **state)
{
	(void)state;
	static const struct form_polygon square = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 4},
					 below = {{{0, 0, -1}, {0, 1, -1}, {1, 1, -1}, {1, 0, -1}}, 4},
					 above = {{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, 4},
					 line = {{{0, 0, 1}, {1, 0, 1}, {2, 0, 1}}, 3},
					 point = {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}, 3};
	static const double starts[][2] = {{0, 0}, {1, 0}, {1, 1}, {0.5, 0.25}, {7, 3}, {1000, 0}};
	const double axis[3] = {2.0 / 3, -1.0 / 3, 2.0 / 3};
	check_nothing(&square, &below); // back to back
	check_nothing(&square, &above); // one sees the other's back
	check_nothing(&square, &line);
	check_nothing(&square, &point);
	check_nothing(&point, &point);
	for (int i = 0; i < 200; i++) {
		for (size_t k = 0; k < sizeof starts / sizeof *starts; k++) {
			struct form_polygon other = square;
			for (int c = 0; c < 4; c++) {
				other.at[c][0] += starts[k][0];
				other.at[c][1] += starts[k][1];
			}
			const struct form_polygon a = placed(&square, axis, 0.1 * i, 1 + i, 0.3 * i);
			const struct form_polygon b = placed(&other, axis, 0.1 * i, 1 + i, 0.3 * i);
			check_nothing(&a, &b);
		}
	}
}

static void neighbours_in_floats_cost_little_where_little_is_enough(void **state)
{
	(void)state;
	uint32_t seed = 3;
	for (int i = 0; i < 100; i++) {
		struct form_polygon two[2] = {{.corners = 4}, {.corners = 4}};
		double u[3], v[3], error;
		for (int c = 0; c < 3; c++) {
			u[c] = 2 * noise(&seed) - 1;
			v[c] = 2 * noise(&seed) - 1;
		}
		for (int k = 0; k < 8; k++)
			for (int c = 0; c < 3; c++)
				two[k / 4].at[k % 4][c] =
				    (double)(float)(u[c] * (k / 4 + (k % 4 == 1 || k % 4 == 2)) + v[c] * (k % 4 > 1));
		const double enough = 1e-12 * form_factor_area(&two[0]);
		const double sum = form_factor_exchange(&two[0], &two[1], enough, &error);
		assert_true(sum <= enough && error <= enough && sum >= -error);
	}
}

static void numbers_that_are_none_are_told(void **state)
{
	(void)state;
	const struct form_polygon square = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 4};
	static const double bad[] = {NAN, INFINITY, -INFINITY};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct form_polygon p = square;
		double error;
		p.at[2][1] = bad[i];
		assert_true(isnan(form_factor_exchange(&p, &square, 0, &error)) && isinf(error));
		assert_true(isnan(form_factor_exchange(&square, &p, 0, &error)) && isinf(error));
	}
}

// What is no convex polygon has no form factor, but an end.
static void shapes_that_are_not_convex_harm_nothing(void **state)
{
	(void)state;
	uint32_t seed = 7;
	for (int i = 0; i < 300; i++) {
		struct form_polygon p = {.corners = 6}, q = {.corners = 6};
		double error;
		for (int k = 0; k < 18; k++) {
			p.at[k / 3][k % 3] = noise(&seed) - 0.5;
			q.at[k / 3][k % 3] = noise(&seed) - 0.5;
		}
		const double is = form_factor_exchange(&p, &q, 1e-3, &error);
		assert_true(isfinite(is) && error >= 0);
		assert_true(isfinite(form_factor_at(q.at[0], (const double[3]){0, 0, 1}, &p)));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(rows_of_closed_bodies_are_1),
	    cmocka_unit_test(a_ball_in_a_ball_is_1_and_a_quarter),
	    cmocka_unit_test(polygons_become_discs),
	    cmocka_unit_test(six_corners_are_a_fan_of_triangles),
	    cmocka_unit_test(an_element_sees_what_closed_forms_say),
	    cmocka_unit_test(what_sees_nothing_has_exactly_0),
	    cmocka_unit_test(neighbours_in_floats_cost_little_where_little_is_enough),
	    cmocka_unit_test(numbers_that_are_none_are_told),
	    cmocka_unit_test(shapes_that_are_not_convex_harm_nothing),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
