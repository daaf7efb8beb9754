// Values at corners: what is even stays so, what is linear too; what is shown has no jump where a surface goes on, also
// where elements of different sizes meet; nothing gets across creases, walls and from side to side.
#include "tests/unit/corner_check.h"

// ---- means ------------------------------------------------------------------------------------------------------------

static void even_light_stays_the_same(void **state)
{
	static struct mesh m;
	struct shown s;
	(void)state;
	cornell_box(&m);
	shuffle(&m);
	show(&m, 0.07, &s);
	for (uint32_t i = 0; i < s.e.count; i++)
		for (uint32_t k = 0; k < 3; k++)
			s.light[3 * i + k] = k == 0 ? 0.1f : k == 1 ? 12345.678f : 3e-20f;
	evaluate(&s, NULL);
	for (uint32_t i = 0; i < 12 * s.e.count; i++)
		assert_true(s.values[i] == s.light[i % 3]);
	unshow(&s);
}

// On grids of quads and of triangles, front and back, within the surface and at its border.
static void linear_light_stays_linear(void **state)
{
	static const double o[3] = {0, 0, 0}, x[3] = {2, 0, 0}, y[3] = {0, 1, 0.5}, far[3] = {4, 0, 0}, up[3] = {2, 3, 1.5};
	static const double slope[3] = {1.5, -2, 0.25};
	static struct mesh m;
	(void)state;
	for (int triangle = 0; triangle < 2; triangle++) {
		struct shown s;
		uint32_t corners = 0;
		start(&m);
		if (triangle)
			add(&m, o, far, up, 0);
		else
			add_quad(&m, o, x, y, 0);
		show(&m, 0.1, &s);
		for (uint32_t i = 0; i < s.e.count; i++) {
			light_at_middle(&s, i, slope);
			s.light[3 * i] += 10;
		}
		evaluate(&s, NULL);
		for (uint32_t i = 0; i < s.e.count; i++) {
			const float *corner = s.e.shapes[i % s.e.patches.count].corner;
			for (uint32_t k = 0; k < 4; k++) {
				const double at[3] = {(double)corner[3 * k], (double)corner[3 * k + 1],
						      (double)corner[3 * k + 2]};
				corners++;
				check_close("linear", (double)s.values[12 * i + 3 * k], 10 + vec3_dot(at, slope), 1e-5);
			}
		}
		assert_true(corners > 1000);
		unshow(&s);
	}
}

// A grid of squares of side 0.1 whose light is a function of the place in its plane.
static void show_grid(struct mesh *m, double (*light)(double x, double y), struct shown *s)
{
	static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
	start(m);
	add_quad(m, o, x, y, 0);
	show(m, 0.1, s);
	for (uint32_t i = 0; i < s->e.count; i++) {
		const float *c = s->e.shapes[i % s->e.patches.count].corner;
		s->light[3 * i] = (float)light(((double)c[0] + (double)c[6]) / 2, ((double)c[1] + (double)c[7]) / 2);
	}
	evaluate(s, NULL);
}

// Irradiance from a narrow, endless lamp, which looks down at the line x = 0 from 0.3 above: over r⁴ of its points,
// integrated along it, it is proportional to 1 / r³. 1 on the line.
static double below_a_line(double x, double y)
{
	(void)y;
	return pow(0.3 / sqrt(0.09 + x * x), 3);
}

static double step(double x, double y)
{
	return x < 0.1 && y < 0.1 ? 1 : 0;
}

// At a border the light of a lamp above it is nearer to the truth than the mean of patches that are all on one side.
static void borders_have_their_own_light(void **state)
{
	static const double mid[3] = {0, 0.5, 0}, far[3] = {1, 0.5, 0};
	static struct mesh m;
	struct shown s;
	(void)state;
	show_grid(&m, below_a_line, &s);
	for (uint32_t i = 0; i < s.e.patches.count; i++) {
		const float *c = s.e.shapes[i].corner;
		const double mean = (double)s.light[3 * i], end = below_a_line(1, 0.5);
		if (c[0] == 0 && c[1] == 0.5f)
			assert_true(fabs(value_at(&s, i, mid) - 1) < 0.7 * fabs(mean - 1));
		if (c[3] == 1 && c[4] == 0.5f)
			assert_true(fabs(value_at(&s, i, far) - end) < 0.5 * fabs(mean - end));
	}
	unshow(&s);
}

// A lone bright patch in a corner makes nothing negative, and does not stand out more.
static void borders_stay_in_bounds(void **state)
{
	static struct mesh m;
	struct shown s;
	float most = 0;
	(void)state;
	show_grid(&m, step, &s);
	for (uint32_t i = 0; i < 12 * s.e.count; i++) {
		assert_true(s.values[i] >= 0);
		most = fmaxf(most, s.values[i]);
	}
	assert_true(most == 1);
	unshow(&s);
}

// The mean does not depend on into how many pieces its parts are cut: weights are angles.
static void a_mean_is_by_angle(void **state)
{
	static const double o[3] = {0, 0, 0}, a[3] = {1, 0, 0}, b[3] = {0, 1, 0}, c[3] = {-1, 0, 0}, d[3] = {0, -1, 0};
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	add(&m, o, a, b, 0); // 90°
	add(&m, o, b, c, 1); // 90°
	add(&m, o, c, d, 2); // 90°, and nothing in the last quarter
	show(&m, INFINITY, &s);
	for (uint32_t i = 0; i < s.e.patches.count; i++)
		s.light[3 * i] = (float)(i + 1) * (float)(i + 1);
	evaluate(&s, NULL);
	check_close("at o", value_at(&s, 0, o), (1 + 4 + 9) / 3.0, 1e-6);
	check_close("at b", value_at(&s, 0, b), (1 + 4) / 2.0, 1e-6);
	check_close("at a", value_at(&s, 0, a), 1, 0);
	unshow(&s);
	start(&m);
	add(&m, o, a, b, 0);
	add(&m, o, b, (const double[3]){-1, 1, 0}, 1); // 45°
	add(&m, o, (const double[3]){-1, 1, 0}, c, 2); // 45°
	show(&m, INFINITY, &s);
	for (uint32_t i = 0; i < s.e.patches.count; i++)
		s.light[3 * i] = i == 0 ? 1 : 4;
	evaluate(&s, NULL);
	check_close("at o", value_at(&s, 0, o), 2.5, 1e-6);
	unshow(&s);
}

// ---- creases ----------------------------------------------------------------------------------------------------------

// What two squares that share an edge have there, if the second is turned by an angle, and its corners the other way round.
static void check_fold(double angle, bool turned, bool smooth)
{
	static struct mesh m;
	const double o[3] = {0.3, 0, 0}, x[3] = {0, 0, 1}, y[3] = {-1, 0, 0}, z[3] = {cos(angle), sin(angle), 0};
	struct shown s;
	start(&m);
	add_quad(&m, o, y, x, 0);
	add_quad(&m, o, turned ? z : x, turned ? x : z, 1);
	show(&m, INFINITY, &s);
	assert_int_equal(s.e.count, 4);
	for (uint32_t i = 0; i < 4; i++)
		s.light[3 * i] = (float)(1u << i);
	evaluate(&s, NULL);
	for (uint32_t i = 0; i < 4; i++) {
		// The other patch's element that is on the same side.
		const uint32_t other = turned ? 3 - i : (i & 2) | !(i & 1);
		const double own = 1u << i, mean = smooth ? (own + (1u << other)) / 2 : own;
		check_close("shared", value_at(&s, i, o), mean, 0);
		check_close("far", value_at(&s, i, (const double[3]){i & 1 ? 0.3 + z[0] : -0.7, i & 1 ? z[1] : 0, 0}), own,
			    0);
	}
	unshow(&s);
}

static void nothing_gets_across_a_crease(void **state)
{
	(void)state;
	for (int angle = -170; angle < 180; angle += 10)
		for (int turned = 0; turned < 2; turned++)
			check_fold(angle * 3.14159265358979 / 180, turned, abs(angle) <= 30);
}

static void faces_of_a_box_keep_their_light(void **state)
{
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	add_box(&m, (const double[3]){3, -1, 2}, (const double[3]){1, 2, 3}, 0.7, 0);
	shuffle(&m);
	show(&m, 0.3, &s);
	for (uint32_t i = 0; i < s.e.count; i++)
		s.light[3 * i] = (float)(1 + s.e.shapes[i % s.e.patches.count].face + 10 * (i / s.e.patches.count));
	evaluate(&s, NULL);
	for (uint32_t i = 0; i < s.e.count; i++)
		for (uint32_t k = 0; k < 4; k++)
			assert_true(s.values[12 * i + 3 * k] == s.light[3 * i]);
	unshow(&s);
}

// A floor of two quads, and a wall that stands where they meet: as wide as they are, or half, and cut otherwise.
static void nothing_gets_beneath_a_wall(void **state)
{
	static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, minus[3] = {-1, 0, 0}, y[3] = {0, 0, -1}, up[3] = {0, 1, 0};
	static struct mesh m;
	(void)state;
	for (int half = 0; half < 2; half++)
		for (int fine = 0; fine < 2; fine++) {
			const double width[3] = {0, 0, half ? -0.5 : -1}, height[3] = {0, fine ? 0.2 : 1, 0};
			const double low[3] = {0, 0, 0}, next[3] = {0, fine ? 0.2 : 1, 0};
			struct shown s;
			start(&m);
			add_quad(&m, o, x, y, 0);
			add_quad(&m, o, y, minus, 0);
			add_quad(&m, low, width, height, 1);
			if (fine)
				add_quad(&m, next, width, up, 1);
			show(&m, INFINITY, &s);
			s.light[0] = 1; // the front of the right half
			s.light[3] = 3;
			evaluate(&s, NULL);
			check_close("behind the wall", value_at(&s, 0, o), 1, 0);
			check_close("before the wall", value_at(&s, 1, o), 3, 0);
			check_close("right end", value_at(&s, 0, y), half ? 2 : 1, 0);
			check_close("left end", value_at(&s, 1, y), half ? 2 : 3, 0);
			for (uint32_t i = 2; i < s.e.count; i++)
				for (uint32_t k = 0; k < 4; k++)
					assert_true(s.values[12 * i + 3 * k] == 0);
			unshow(&s);
		}
}

// A floor that is there twice, its fronts outwards: each side keeps its light, and goes on.
static void a_doubled_surface_has_two_sides(void **state)
{
	static const double o[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 0, -1}, minus[3] = {-1, 0, 0};
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	add_quad(&m, o, x, y, 0);
	add_quad(&m, o, y, x, 1);
	add_quad(&m, o, y, minus, 2);
	add_quad(&m, o, minus, y, 3);
	show(&m, INFINITY, &s);
	assert_int_equal(s.e.patches.count, 4);
	for (uint32_t i = 0; i < 4; i++)
		s.light[3 * i] = (float)(1u << i);
	evaluate(&s, NULL);
	const double upper = s.light[0] + s.light[6], lower = s.light[3] + s.light[9];
	for (uint32_t i = 0; i < 4; i++)
		check_close("middle", value_at(&s, i, o), (i % 2 ? lower : upper) / 2, 0);
	unshow(&s);
}

// ---- T-junctions ------------------------------------------------------------------------------------------------------

static void a_corner_on_a_side_has_its_light(void **state)
{
	static const double o[3] = {0, 0, 0}, left[3] = {-1, 0, 0}, y[3] = {0, 1, 0}, x[3] = {0.5, 0, 0},
			    half[3] = {0, 0.5, 0};
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	add_quad(&m, o, y, left, 0);
	add_quad(&m, o, x, half, 1);
	add_quad(&m, half, x, half, 2);
	show(&m, INFINITY, &s);
	assert_int_equal(s.e.patches.count, 3);
	for (uint32_t i = 0; i < 3; i++)
		s.light[3 * i] = (float)(1u << (2 * i));
	evaluate(&s, NULL);
	check_close("low", value_at(&s, 0, o), (1 + 4) / 2.0, 0);
	check_close("high", value_at(&s, 0, y), (1 + 16) / 2.0, 0);
	check_close("between", value_at(&s, 1, half), (2.5 + 8.5) / 2, 0);
	check_close("between", value_at(&s, 2, half), (2.5 + 8.5) / 2, 0);
	check_close("right", value_at(&s, 1, (const double[3]){0.5, 0.5, 0}), (4 + 16) / 2.0, 0);
	assert_int_equal(check_seams(&s, 1e-6), 1);
	unshow(&s);
}

// A floor of many faces, each its own material and cut in 1, 2, 4 … parts more than the next, scaled and turned.
static void there_are_no_seams(void **state)
{
	static const double scales[] = {1, 1e-3, 0.1, 10, 1e3, 1e6};
	static struct mesh m;
	static float last[64];
	(void)state;
	for (size_t k = 0; k < sizeof scales / sizeof *scales; k++) {
		struct shown s;
		pieced_floor(&m, scales[k]);
		show(&m, INFINITY, &s);
		for (uint32_t i = 0; i < s.e.count; i++)
			s.light[3 * i] = (float)noise(&m.seed);
		evaluate(&s, NULL);
		assert_true(check_seams(&s, 2e-6) > 20);
		for (uint32_t i = 0; i < 64; i++)
			assert_true(k == 0 || fabsf(s.values[3 * i] - last[i]) < 1e-5f);
		for (uint32_t i = 0; i < 64; i++)
			last[i] = s.values[3 * i];
		unshow(&s);
	}
}

// Four bricks around a fifth, each with its end on the next one's side: each corner depends on the next.
static void a_ring_of_corners_on_sides_has_no_seam(void **state)
{
	static const double at[5][2][2] = {
	    {{0, 0}, {2, 1}}, {{2, 0}, {1, 2}}, {{1, 2}, {2, 1}}, {{0, 1}, {1, 2}}, {{1, 1}, {1, 1}}};
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	for (uint32_t i = 0; i < 5; i++)
		add_quad(&m, (const double[3]){at[i][0][0], at[i][0][1], 0}, (const double[3]){at[i][1][0], 0, 0},
			 (const double[3]){0, at[i][1][1], 0}, i);
	show(&m, INFINITY, &s);
	for (uint32_t i = 0; i < 5; i++)
		s.light[3 * i] = (float)(i * i);
	evaluate(&s, NULL);
	assert_int_equal(check_seams(&s, 1e-5), 4);
	unshow(&s);
}

// A sky as far as may be does not make corners of a small thing the same.
static void a_far_sky_makes_nothing_coarse(void **state)
{
	static struct mesh m;
	struct shown s;
	(void)state;
	pieced_floor(&m, 0.01);
	add_quad(&m, (const double[3]){-1e6, -1e6, 1e6}, (const double[3]){2e6, 0, 0}, (const double[3]){0, 2e6, 0}, 1000);
	show(&m, INFINITY, &s);
	for (uint32_t i = 0; i < s.e.count; i++)
		s.light[3 * i] = (float)noise(&m.seed);
	evaluate(&s, NULL);
	assert_true(check_seams(&s, 2e-6) > 20);
	unshow(&s);
}

// ---- what light does not reach, slices, hostile sizes -----------------------------------------------------------------

static void what_no_light_reaches_gives_and_gets_nothing(void **state)
{
	static const double o[3] = {0, 0, 0}, left[3] = {-1, 0, 0}, y[3] = {0, 1, 0}, x[3] = {0.5, 0, 0},
			    half[3] = {0, 0.5, 0};
	static const uint8_t reached[6] = {0, 1, 1, 1, 1, 1};
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	add_quad(&m, o, y, left, 0);
	add_quad(&m, o, x, half, 1);
	add_quad(&m, half, x, half, 2);
	show(&m, INFINITY, &s);
	s.light[0] = NAN;
	s.light[3] = 4;
	s.light[6] = 16;
	evaluate(&s, reached);
	for (uint32_t i = 0; i < 12; i++)
		assert_true(s.values[i] == 0);
	check_close("low", value_at(&s, 1, o), 4, 0);
	check_close("between", value_at(&s, 1, half), 10, 0);
	unshow(&s);
}

static void the_same_bits_whatever_the_slices(void **state)
{
	static struct mesh m;
	float *kept = NULL;
	(void)state;
	for (uint32_t budget = 0; budget < 3; budget++) {
		struct shown s;
		pieced_floor(&m, 1);
		cornell_box_beside(&m);
		show_by(&m, 0.05, budget * budget * 500, &s);
		const size_t bytes = 12 * s.e.count * sizeof *s.values;
		for (uint32_t i = 0; i < s.e.count; i++)
			s.light[3 * i] = (float)noise(&m.seed);
		for (int again = 0; again < 2; again++) {
			evaluate(&s, NULL);
			if (!kept)
				memcpy(kept = malloc(bytes), s.values, bytes);
			assert_memory_equal(kept, s.values, bytes);
		}
		unshow(&s);
	}
	free(kept);
}

// Thousands of needles with one long side, and their tips on it: it ends, and is right where nothing lies on anything.
static void heaps_of_needles_end(void **state)
{
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	for (uint32_t i = 0; i < MOST - 2; i++) {
		const double tip = (i + 1.0) / MOST;
		add(&m, (const double[3]){0, 0, 0}, (const double[3]){1, 0, 0}, (const double[3]){tip, 1e-9 * (i % 3), 1e-4},
		    i);
	}
	add_quad(&m, (const double[3]){5, 5, 5}, (const double[3]){1, 0, 0}, (const double[3]){0, 1, 0}, MOST);
	show(&m, INFINITY, &s);
	for (uint32_t i = 0; i < s.e.count; i++)
		s.light[3 * i] = (float)i;
	evaluate(&s, NULL);
	for (uint32_t i = 0; i < 12 * s.e.count; i++)
		assert_true(isfinite(s.values[i]));
	for (uint32_t k = 0; k < 4; k++)
		assert_true(s.values[12 * (s.e.patches.count - 1) + 3 * k] == s.light[3 * (s.e.patches.count - 1)]);
	unshow(&s);
	// Tips on the side of all, where each is looked for on each.
	start(&m);
	for (uint32_t i = 0; i < MOST - 2; i++)
		add(&m, (const double[3]){i * 1e-6, 0, 0}, (const double[3]){1 + i * 1e-6, 0, 0},
		    (const double[3]){0.5, cos(i), sin(i)}, i);
	show(&m, INFINITY, &s);
	evaluate(&s, NULL);
	unshow(&s);
	assert_true(corners_bytes(UINT32_MAX) > UINT32_MAX && corners_bytes(0) < 65536);
}

static void a_scene_of_nothing_is_finished(void **state)
{
	static struct mesh m;
	struct shown s;
	(void)state;
	start(&m);
	show(&m, 1, &s);
	evaluate(&s, NULL);
	unshow(&s);
	corners_destroy(NULL);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(even_light_stays_the_same),
	    cmocka_unit_test(linear_light_stays_linear),
	    cmocka_unit_test(borders_have_their_own_light),
	    cmocka_unit_test(borders_stay_in_bounds),
	    cmocka_unit_test(a_mean_is_by_angle),
	    cmocka_unit_test(nothing_gets_across_a_crease),
	    cmocka_unit_test(faces_of_a_box_keep_their_light),
	    cmocka_unit_test(nothing_gets_beneath_a_wall),
	    cmocka_unit_test(a_doubled_surface_has_two_sides),
	    cmocka_unit_test(a_corner_on_a_side_has_its_light),
	    cmocka_unit_test(there_are_no_seams),
	    cmocka_unit_test(a_ring_of_corners_on_sides_has_no_seam),
	    cmocka_unit_test(a_far_sky_makes_nothing_coarse),
	    cmocka_unit_test(what_no_light_reaches_gives_and_gets_nothing),
	    cmocka_unit_test(the_same_bits_whatever_the_slices),
	    cmocka_unit_test(heaps_of_needles_end),
	    cmocka_unit_test(a_scene_of_nothing_is_finished),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
