// Polygons are cut into triangles that make the whole polygon and nothing else, whatever their shape, in few comparisons.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/loader/obj_polygon.h"

#define MOST (1u << 18)

struct point {
	int32_t x, y;
};

static struct point shape[MOST];
static uint32_t size;
static uint64_t state;

// A fixed sequence of numbers below `count`.
static uint32_t random_below(uint32_t count)
{
	state = state * 6364136223846793005ull + 1442695040888963407ull;
	return (uint32_t)((state >> 33) % count);
}

static void add(int32_t x, int32_t y)
{
	assert_true(size < MOST);
	shape[size++] = (struct point){x, y};
}

static int64_t area(struct point a, struct point b, struct point c)
{
	return (int64_t)(b.x - a.x) * (c.y - a.y) - (int64_t)(b.y - a.y) * (c.x - a.x);
}

// ---- what must be true

// The sides of all triangles, in order of their corners: of a polygon's own sides each is there once, of all others each is
// there both ways.
static int compare_sides(const void *pa, const void *pb)
{
	const uint64_t a = *(const uint64_t *)pa, b = *(const uint64_t *)pb;
	return (a > b) - (a < b);
}

static void check_sides(const struct obj_polygon *p)
{
	static uint64_t there[3 * MOST], back[3 * MOST];
	size_t sides = 0;
	for (uint32_t t = 0; t + 2 < p->count; t++)
		for (int k = 0; k < 3; k++) {
			const uint32_t a = p->triangles[t][k], b = p->triangles[t][(k + 1) % 3];
			assert_true(a < p->count && b < p->count && a != b);
			there[sides] = (uint64_t)a << 32 | b;
			back[sides++] = (uint64_t)b << 32 | a;
		}
	for (uint32_t i = 0; i < p->count; i++) {
		const uint32_t next = (i + 1) % p->count;
		there[sides] = (uint64_t)next << 32 | i;
		back[sides++] = (uint64_t)i << 32 | next;
	}
	qsort(there, sides, sizeof *there, compare_sides);
	qsort(back, sides, sizeof *back, compare_sides);
	for (size_t i = 0; i < sides; i++)
		assert_true(there[i] == back[i] && (i == 0 || there[i] != there[i - 1]));
}

// Ways to lay a shape into space; the last ones round it, so that what is on a line there is not quite so here.
#define WAYS 6

static void place(double corner[3], struct point at, int way)
{
	const double x = at.x, y = at.y;
	const double places[WAYS][3] = {{x, y, 7},
					{y * 0x1p40, .25 * x, x * 0x1p40},
					{-3, y * 0x1p-50, x * 0x1p-50},
					{x * .1, y * .1, x * .01},
					{.003 + y * .017, 0, x * .013 - .77},
					{y, 300 + x * .7, 1e5 + y * .3}};
	memcpy(corner, places[way], sizeof places[way]);
}

static int64_t twice_area(void)
{
	int64_t sum = 0;
	for (uint32_t i = 1; i + 1 < size; i++)
		sum += area(shape[0], shape[i], shape[i + 1]);
	return sum;
}

// Cut the shape, from one of its corners on. If it does not cross itself, no triangle turns otherwise than it does: with its
// sides and area as they are, that is all there is to it. Returns how many triangles turn otherwise.
static uint32_t cut(struct obj_polygon *p, uint32_t start, int way, bool backwards)
{
	struct error err;
	const int64_t whole = twice_area();
	int64_t sum = 0;
	uint32_t wrong = 0;
	p->comparisons = 0;
	assert_int_equal(obj_polygon_reserve(p, size, &err), STATUS_OK);
	p->count = size;
	for (uint32_t i = 0; i < size; i++)
		place(p->corners[i], shape[(start + (backwards ? size - i : i)) % size], way);
	assert_int_equal(obj_polygon_cut(p, &err), STATUS_OK);
	check_sides(p);
	for (uint32_t t = 0; t + 2 < size; t++) {
		struct point at[3];
		for (int k = 0; k < 3; k++) {
			const uint32_t i = p->triangles[t][k];
			at[k] = shape[(start + (backwards ? size - i : i)) % size];
		}
		const int64_t twice = (backwards ? -1 : 1) * area(at[0], at[1], at[2]);
		wrong += whole > 0 ? twice < 0 : twice > 0;
		sum += twice;
	}
	assert_int_equal(sum, whole);
	return wrong;
}

static void check_all_ways(uint32_t start)
{
	struct obj_polygon p = {0};
	for (int way = 0; way < WAYS; way++)
		for (int backwards = 0; backwards < 2; backwards++)
			assert_int_equal(cut(&p, start, way, backwards), 0);
	obj_polygon_finish(&p);
}

// ---- shapes that touch themselves in all ways

#define SIDE 12 // squares of a lattice, each cut into two triangles by its rising diagonal

static bool used[SIDE][SIDE][2];

static int32_t least(int32_t a, int32_t b, int32_t c)
{
	return a < b ? (a < c ? a : c) : (b < c ? b : c);
}

// Take the triangle on the right of a side, if it is there and free. *apex becomes its third corner.
static bool take_triangle(struct point a, struct point b, struct point *apex)
{
	static const struct point ways[6] = {{1, 0}, {1, 1}, {0, 1}, {-1, 0}, {-1, -1}, {0, -1}};
	int k = 0;
	while (ways[k].x != b.x - a.x || ways[k].y != b.y - a.y)
		k++;
	const struct point c = {a.x + ways[(k + 5) % 6].x, a.y + ways[(k + 5) % 6].y};
	const int32_t x = least(a.x, b.x, c.x), y = least(a.y, b.y, c.y);
	if (x < 0 || y < 0 || x >= SIDE || y >= SIDE)
		return false;
	bool *taken = &used[y][x][a.x + b.x + c.x - 3 * x == 1];
	const bool free = !*taken;
	*taken = true;
	*apex = c;
	return free;
}

static void insert(uint32_t place, struct point at)
{
	assert_true(size < MOST);
	memmove(shape + place + 1, shape + place, (size - place) * sizeof *shape);
	shape[place] = at;
	size++;
}

static void leave_out(uint32_t place)
{
	memmove(shape + place, shape + place + 1, (size - place - 1) * sizeof *shape);
	size--;
}

// A tree of triangles that share one side each: where others lie beside each other, sides lead there and back, and corners
// meet in one place.
static void make_tree(uint32_t triangles)
{
	memset(used, 0, sizeof used);
	used[SIDE / 2][SIDE / 2][0] = true;
	size = 0;
	add(SIDE / 2, SIDE / 2);
	add(SIDE / 2 + 1, SIDE / 2);
	add(SIDE / 2 + 1, SIDE / 2 + 1);
	for (uint32_t tries = 0; tries < 50 * triangles && size < triangles + 2; tries++) {
		struct point apex;
		const uint32_t i = random_below(size);
		if (take_triangle(shape[i], shape[(i + 1) % size], &apex))
			insert(i + 1, apex);
	}
}

// Leave out corners on straight sides, so that others touch sides between corners.
static void straighten(uint32_t one_of)
{
	for (uint32_t i = size; i-- > 0 && size > 3;) {
		const struct point a = shape[i > 0 ? i - 1 : size - 1], b = shape[i], c = shape[(i + 1) % size];
		const int64_t ahead = (int64_t)(b.x - a.x) * (c.x - b.x) + (int64_t)(b.y - a.y) * (c.y - b.y);
		if (area(a, b, c) == 0 && ahead > 0 && random_below(one_of) == 0)
			leave_out(i);
	}
}

// Ways of no width that lead somewhere and back, and corners that are there twice.
static void make_spikes(uint32_t count)
{
	for (uint32_t k = 0; k < count; k++) {
		const uint32_t i = random_below(size);
		const struct point at = shape[i];
		insert(i + 1, at);
		if (random_below(3) > 0)
			insert(i + 1,
			       (struct point){at.x + (int32_t)random_below(5) - 2, at.y + (int32_t)random_below(5) - 2});
	}
}

static void move(int32_t a, int32_t b, int32_t c, int32_t d, int32_t x)
{
	for (uint32_t i = 0; i < size; i++)
		shape[i] = (struct point){a * shape[i].x + b * shape[i].y + x, c * shape[i].x + d * shape[i].y};
}

static uint32_t rightmost(void)
{
	uint32_t found = 0;
	for (uint32_t i = 1; i < size; i++)
		found = shape[i].x > shape[found].x ? i : found;
	return found;
}

// Make a second shape beside the one that is there, and a side from that to it and back.
static void make_another(uint32_t triangles)
{
	static struct point first[MOST];
	const uint32_t count = size, join = rightmost();
	memcpy(first, shape, count * sizeof *first);
	make_tree(triangles);
	move(-1, 0, 0, -1, 0);
	const uint32_t other = rightmost(), others = size;
	static struct point second[MOST];
	for (uint32_t i = 0; i <= others; i++)
		second[i] = (struct point){3 * SIDE - shape[(other + i) % others].x, -shape[(other + i) % others].y};
	size = 0;
	for (uint32_t i = 0; i <= count; i++)
		add(first[(join + i) % count].x, first[(join + i) % count].y);
	for (uint32_t i = 0; i <= others; i++)
		add(second[i].x, second[i].y);
}

static void test_shapes_that_touch_themselves(void **unused)
{
	(void)unused;
	for (uint32_t k = 0; k < 2000; k++) {
		state = k;
		make_tree(1 + random_below(k % 8 == 0 ? 250 : 30));
		if (k % 7 == 1)
			make_another(1 + random_below(30));
		if (k % 2 == 1)
			straighten(1 + random_below(3));
		if (k % 3 == 2)
			make_spikes(1 + random_below(4));
		if (k % 5 > 1)
			move(3, 1, -(int32_t)(k % 5), 2, 0);
		check_all_ways(random_below(size));
	}
}

// A part that stands on another's side, rounded to either side of it, beside a notch in that.
static void test_a_corner_on_a_side(void **unused)
{
	static const struct point ring[] = {{0, 0},    {100, 0},   {100, 100}, {70, 100}, {60, 50},
					    {50, 100}, {-60, 100}, {0, 0},     {-27, 85}, {-24, 80}};
	(void)unused;
	for (int32_t k = 0; k < 200; k++) {
		size = sizeof ring / sizeof *ring;
		memcpy(shape, ring, sizeof ring);
		shape[7] = (struct point){-3 * (1 + k % 4), 10 * (1 + k % 4)};
		move(k % 8 < 4 ? 1 : -1, 0, 0, 1, k * 37);
		check_all_ways((uint32_t)k % size);
	}
}

// ---- many corners

static void make_comb(uint32_t count)
{
	size = 0;
	add((int32_t)count, -1);
	for (uint32_t i = count; i-- > 1;)
		add((int32_t)i, i % 2 ? 1000 : 0);
	add(0, -1);
}

static void make_spiral(uint32_t count)
{
	size = 0;
	for (uint32_t i = 0; i < count; i++) {
		const uint32_t k = i < count / 2 ? i : count - 1 - i;
		const double r = 1000 + 30 * (double)k + (i < count / 2 ? 400 : 0),
			     angle = 3.14159265358979 / 16 * (double)k;
		add((int32_t)(r * cos(angle)), (int32_t)(r * sin(angle)));
	}
}

static void make_walk(uint32_t count)
{
	size = 0;
	for (uint32_t i = 0; i < count; i++)
		add((int32_t)random_below(1000000), (int32_t)random_below(1000000));
}

static void make_line(uint32_t count)
{
	size = 0;
	for (uint32_t i = 0; i < count; i++) {
		const int32_t at = (int32_t)random_below(1000);
		add(at, 2 * at);
	}
	add(0, 1);
}

static void make_laps(uint32_t count)
{
	size = 0;
	for (uint32_t i = 0; i < count; i++)
		add(i % 4 == 0 ? -1 : i % 4 == 2, i % 4 == 1 ? -1 : i % 4 == 3);
}

static void make_star(uint32_t count)
{
	size = 0;
	for (uint32_t i = 0; i < count; i++) {
		const double angle = 2 * 3.14159265358979 * (double)i * (double)(count / 2 - 1) / (double)count;
		add((int32_t)(1e6 * cos(angle)), (int32_t)(1e6 * sin(angle)));
	}
}

static void test_many_corners(void **unused)
{
	static const struct {
		void (*make)(uint32_t count);
		bool crosses;
	} shapes[] = {{make_comb, false}, {make_spiral, false}, {make_walk, true},
		      {make_line, true},  {make_laps, true},    {make_star, true}};
	struct obj_polygon p = {0};
	(void)unused;
	state = 1;
	for (size_t k = 0; k < sizeof shapes / sizeof *shapes; k++)
		for (uint32_t count = 1000; count <= 64000; count *= 4) {
			shapes[k].make(count);
			const uint32_t wrong = cut(&p, count / 3, 0, false);
			assert_true(shapes[k].crosses || wrong == 0);
			assert_true((double)p.comparisons < 2 * size * log2(size));
			assert_true(p.comparisons > 0);
		}
	obj_polygon_finish(&p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(test_shapes_that_touch_themselves),
	    cmocka_unit_test(test_a_corner_on_a_side),
	    cmocka_unit_test(test_many_corners),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
