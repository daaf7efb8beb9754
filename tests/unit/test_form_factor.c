// Form factors of pairs: right to a millionth in every configuration that has a closed form, and by a quadrature that shares
// none with them; bounds that hold; the same at every scale.
#include "tests/unit/form_factor_check.h"

#include "server/base/angle.h"
#include "tests/unit/form_factor_scenes.h"

#define EXPECTED (sizeof expected / sizeof *expected)
#define ALL (2 * EXPECTED)

// Those of corners in double precision, then those that are rounded to float.
static const struct expected *each(size_t i)
{
	return i < EXPECTED ? &expected[i] : &expected_of_floats[i - EXPECTED];
}

_Static_assert(sizeof expected == sizeof expected_of_floats, "both have each configuration");

static struct form_polygon scaled(const struct form_polygon *p, double scale)
{
	return placed(p, (const double[3]){0, 0, 1}, 0, scale, 0);
}

static void closed_forms_are_met_whatever_the_frame(void **state)
{
	(void)state;
	static const double axis[3] = {2.0 / 7, 3.0 / 7, 6.0 / 7};
	for (size_t i = 0; i < ALL; i++) {
		const struct expected *e = each(i);
		double error;
		const double is = form_factor_exchange(&e->a, &e->b, 0, &error);
		check_close(e->name, is, e->exchange, 1e-6);
		if (!(fabs(is - e->exchange) <= error + 1e-13 * is))
			fail_msg("%s: %.2g off, which is not within %.2g", e->name, fabs(is - e->exchange), error);
		const struct form_polygon a = placed(&e->a, axis, 0.7, 1, 0.25), b = placed(&e->b, axis, 0.7, 1, 0.25);
		check_close(e->name, exchange(&b, &a), e->exchange, 1e-6);
	}
}

// The limit of a gap of nothing, from which 10⁻¹⁰ is 10⁻⁸ away.
static void squares_that_nearly_touch_exchange_what_overlaps(void **state)
{
	(void)state;
	static const struct form_polygon floor = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, 4},
					 lid = {{{-1, -1, 1e-10}, {-1, 1, 1e-10}, {1, 1, 1e-10}, {1, -1, 1e-10}}, 4};
	for (int degrees = 5; degrees <= 45; degrees += 5) {
		const double angle = degrees * PI / 180, cosine = cos(angle), sine = sin(angle);
		const struct form_polygon turned = placed(&lid, (const double[3]){0, 0, 1}, angle, 1, 0);
		// Each corner juts out by cos + sin − 1: a right triangle of that height.
		const double height = cosine + sine - 1, corner = height * height / (2 * cosine * sine);
		check_close("overlap", exchange(&floor, &turned), 4 - 4 * corner, 1e-7);
	}
}

static void scales_do_not_matter(void **state)
{
	(void)state;
	static const double scales[] = {1e-3, 0.1, 1e3, 1e6};
	for (size_t i = 0; i < EXPECTED; i++) {
		const struct expected *e = &expected[i];
		double error, unused;
		const double one = form_factor_exchange(&e->a, &e->b, 0, &error);
		for (size_t k = 0; k < 2 && e->exchange > 1e-9; k++) {
			const double two = k ? 0x1p-40 : 0x1p40;
			const struct form_polygon a = scaled(&e->a, two), b = scaled(&e->b, two);
			assert_true(form_factor_exchange(&a, &b, 0, &unused) == one * two * two);
		}
		for (size_t k = 0; k < 4 && error < 1e-9 * one; k++) {
			const struct form_polygon a = scaled(&e->a, scales[k]), b = scaled(&e->b, scales[k]);
			const double is = form_factor_exchange(&a, &b, 0, &unused) / (scales[k] * scales[k]);
			check_close(e->name, is, one, fmax(1e-12, 2 * error / one));
		}
	}
}

// ---- a quadrature of our own ------------------------------------------------------------------------------------------

// Three points of Gauss, scaled to [0, 1].
static const double node[3] = {0.11270166537925831148, 0.5, 0.88729833462074168852};
static const double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};

// A place on a quad or triangle, and the area about it for a unit of the square that is mapped to it.
static double place(const struct form_polygon *p, double x, double y, double out[3])
{
	const double *v = p->at[0], *w = p->at[1], *s = p->at[2], *t = p->at[p->corners - 1];
	double du[3], dv[3], cross[3];
	for (int c = 0; c < 3; c++) {
		du[c] = (1 - y) * (w[c] - v[c]) + y * (s[c] - t[c]);
		dv[c] = (1 - x) * (t[c] - v[c]) + x * (s[c] - w[c]);
		out[c] = v[c] + x * (w[c] - v[c]) + y * (t[c] - v[c]) + x * y * (s[c] - w[c] - t[c] + v[c]);
	}
	vec3_cross(du, dv, cross);
	return sqrt(vec3_dot(cross, cross));
}

static void normal_of(const struct form_polygon *p, double out[3])
{
	double u[3], v[3];
	for (int c = 0; c < 3; c++) {
		u[c] = p->at[1][c] - p->at[0][c];
		v[c] = p->at[2][c] - p->at[0][c];
	}
	vec3_cross(u, v, out);
	assert_true(vec3_normalize(out));
}

struct cell {
	double x, y, wide, high;
};

// What a cell of `a` sends to `b`.
static double of_cell(const struct form_polygon *a, const double normal[3], const struct form_polygon *b, struct cell c)
{
	double sum = 0;
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++) {
			double at[3];
			const double area = place(a, c.x + c.wide * node[i], c.y + c.high * node[j], at);
			sum += weight[i] * weight[j] * area * fmax(0, form_factor_at(at, normal, b));
		}
	}
	return sum * c.wide * c.high;
}

// The same, halved along the axis on which that changes more, until it changes less than `enough`.
static double adapted(const struct form_polygon *a, const double normal[3], const struct form_polygon *b, struct cell c,
		      double whole, double enough, int depth)
{
	const double w = c.wide / 2, h = c.high / 2;
	const struct cell halves[2][2] = {{{c.x, c.y, w, c.high}, {c.x + w, c.y, w, c.high}},
					  {{c.x, c.y, c.wide, h}, {c.x, c.y + h, c.wide, h}}};
	double sums[2][2];
	for (int k = 0; k < 4; k++)
		sums[k / 2][k % 2] = of_cell(a, normal, b, halves[k / 2][k % 2]);
	const double by_x = fabs(sums[0][0] + sums[0][1] - whole), by_y = fabs(sums[1][0] + sums[1][1] - whole);
	const int axis = by_y > by_x;
	if (fmax(by_x, by_y) <= enough || depth == 60)
		return sums[axis][0] + sums[axis][1];
	return adapted(a, normal, b, halves[axis][0], sums[axis][0], enough, depth + 1) +
	       adapted(a, normal, b, halves[axis][1], sums[axis][1], enough, depth + 1);
}

#define GRID 6
#define SAMPLES (9 * GRID * GRID)

static void sample(const struct form_polygon *p, double at[SAMPLES][3], double area[SAMPLES])
{
	for (int i = 0; i < SAMPLES; i++) {
		const int x = i / (3 * GRID), y = i % (3 * GRID);
		const double u = (x / 3 + node[x % 3]) / GRID, v = (y / 3 + node[y % 3]) / GRID;
		area[i] = place(p, u, v, at[i]) * weight[x % 3] * weight[y % 3] / (GRID * GRID);
	}
}

// ∫∫ cos cos / (π r²) point by point, for polygons apart.
static double point_by_point(const struct form_polygon *a, const struct form_polygon *b)
{
	double n[3], m[3], sum = 0, p[SAMPLES][3], q[SAMPLES][3], of_p[SAMPLES], of_q[SAMPLES];
	normal_of(a, n);
	normal_of(b, m);
	sample(a, p, of_p);
	sample(b, q, of_q);
	for (int i = 0; i < SAMPLES; i++) {
		for (int k = 0; k < SAMPLES; k++) {
			const double r[3] = {q[k][0] - p[i][0], q[k][1] - p[i][1], q[k][2] - p[i][2]};
			const double square = vec3_dot(r, r);
			sum += of_p[i] * of_q[k] * fmax(0, vec3_dot(n, r)) * fmax(0, -vec3_dot(m, r)) / (square * square);
		}
	}
	return sum / PI;
}

static double quadrature(const struct form_polygon *a, const struct form_polygon *b, double about)
{
	double apart = INFINITY, extent = 0, normal[3];
	for (uint32_t i = 0; i < a->corners; i++)
		for (uint32_t k = 0; k < b->corners; k++)
			apart = fmin(apart, distance(a->at[i], b->at[k]));
	for (uint32_t i = 1; i < 3; i++)
		extent = fmax(extent, fmax(distance(a->at[0], a->at[i]), distance(b->at[0], b->at[i])));
	if (apart > 0.6 * extent)
		return point_by_point(a, b);
	if (form_factor_area(a) > form_factor_area(b))
		return quadrature(b, a, about);
	// Cells become smaller towards the sides, where a neighbour that is near shows in a narrow strip alone.
	double ends[16], sum = 0;
	for (int i = 0; i < 8; i++) {
		ends[i] = i ? ldexp(1, 4 * i - 29) : 0;
		ends[15 - i] = 1 - ends[i];
	}
	normal_of(a, normal);
	for (int i = 0; i < 15; i++) {
		for (int j = 0; j < 15; j++) {
			const struct cell c = {ends[i], ends[j], ends[i + 1] - ends[i], ends[j + 1] - ends[j]};
			sum += adapted(a, normal, b, c, of_cell(a, normal, b, c), 1e-8 * about, 0);
		}
	}
	return sum;
}

static void closed_forms_are_what_a_quadrature_by_area_finds(void **state)
{
	(void)state;
	for (size_t i = 0; i < ALL; i++) {
		const struct expected *e = each(i);
		check_close(e->name, quadrature(&e->a, &e->b, e->exchange), e->exchange, 1e-6);
	}
}

// ---- triangles at random ----------------------------------------------------------------------------------------------

// A triangle or parallelogram whose corners are whole numbers, so that many touch, cross or lie in one plane.
static struct form_polygon whole_numbers(uint32_t *state)
{
	struct form_polygon p = {.corners = 3 + (noise(state) < 0.5)};
	for (int c = 0; c < 3; c++) {
		const double at = floor(3 * noise(state)), u = floor(5 * noise(state)) - 2, v = floor(5 * noise(state)) - 2;
		p.at[0][c] = at;
		p.at[1][c] = at + u;
		p.at[2][c] = p.corners == 4 ? at + u + v : at + v;
		p.at[3][c] = at + v;
	}
	return p;
}

static void pieces_exchange_what_the_whole_does(void **state)
{
	(void)state;
	uint32_t seed = 1, seen = 0;
	for (int i = 0; i < 2000; i++) {
		const struct form_polygon a = whole_numbers(&seed), b = whole_numbers(&seed);
		const double whole = exchange(&a, &b), least = fmin(form_factor_area(&a), form_factor_area(&b));
		struct form_polygon half[2] = {a, a};
		for (int c = 0; c < 3; c++) {
			half[0].at[1][c] = half[1].at[0][c] = (a.at[0][c] + a.at[1][c]) / 2;
			if (a.corners == 4)
				half[0].at[2][c] = half[1].at[3][c] = (a.at[2][c] + a.at[3][c]) / 2;
		}
		assert_true(whole >= 0 && whole <= least * (1 + 1e-9));
		check_close("the other way", exchange(&b, &a), whole, 1e-6);
		check_close("in halves", exchange(&half[0], &b) + exchange(&half[1], &b), whole, 1e-6);
		seen += whole > 0;
	}
	assert_in_range(seen, 500, 1500);
}

static bool in_front(const struct form_polygon *p, const struct form_polygon *of)
{
	double normal[3];
	bool all = true;
	normal_of(of, normal);
	for (uint32_t i = 0; i < p->corners; i++) {
		const double r[3] = {p->at[i][0] - of->at[0][0], p->at[i][1] - of->at[0][1], p->at[i][2] - of->at[0][2]};
		all &= vec3_dot(normal, r) > -1e-9;
	}
	return all;
}

static void triangles_are_what_a_quadrature_finds(void **state)
{
	(void)state;
	uint32_t seed = 9, seen = 0;
	for (int i = 0; i < 400; i++) {
		struct form_polygon a = whole_numbers(&seed), b = whole_numbers(&seed);
		double error;
		a.corners = b.corners = 3;
		const double whole = form_factor_exchange(&a, &b, 0, &error);
		// Where one is cut by the other's plane, the integrand jumps, which is not for this quadrature.
		if (!(whole > 0) || !in_front(&a, &b) || !in_front(&b, &a))
			continue;
		check_close("triangles", quadrature(&a, &b, whole), whole, 1e-6);
		seen++;
	}
	assert_in_range(seen, 40, 400);
}

static void an_element_and_a_triangle_are_what_a_quadrature_finds(void **state)
{
	(void)state;
	const double h = 1e-6;
	const struct form_polygon element = {{{0, 0, 0}, {h, 0, 0}, {h, h, 0}, {0, h, 0}}, 4};
	const struct form_polygon triangle = {{{2, 0.5, 1}, {-1, 2, 2}, {0.5, -1, 4}}, 3};
	const struct form_polygon turned = {{{2, 0.5, 1}, {0.5, -1, 4}, {-1, 2, 2}}, 3};
	const double at[3] = {h / 2, h / 2, 0}, up[3] = {0, 0, 1}, sees = form_factor_at(at, up, &triangle);
	const struct form_polygon *front = sees > 0 ? &triangle : &turned;
	check_close("triangle", fabs(sees), point_by_point(&element, front) / (h * h), 1e-5);
	check_close("triangle", fabs(sees), exchange(&element, front) / (h * h), 1e-6);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(closed_forms_are_met_whatever_the_frame),
	    cmocka_unit_test(closed_forms_are_what_a_quadrature_by_area_finds),
	    cmocka_unit_test(squares_that_nearly_touch_exchange_what_overlaps),
	    cmocka_unit_test(scales_do_not_matter),
	    cmocka_unit_test(pieces_exchange_what_the_whole_does),
	    cmocka_unit_test(triangles_are_what_a_quadrature_finds),
	    cmocka_unit_test(an_element_and_a_triangle_are_what_a_quadrature_finds),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
