#include "server/scene/bvh_refit.h"

#include <string.h>

struct box {
	float min[3], max[3];
};

static struct box empty_box(void)
{
	return (struct box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

// Minimum of two floats that are not NaN. Unlike fminf and fmaxf, it is not a function call.
static float least(float a, float b)
{
	return a < b ? a : b;
}

static float most(float a, float b)
{
	return a > b ? a : b;
}

static void grow(struct box *box, const float min[3], const float max[3])
{
	for (int c = 0; c < 3; c++) {
		box->min[c] = least(box->min[c], min[c]);
		box->max[c] = most(box->max[c], max[c]);
	}
}

static struct box box_of_leaf(const struct leaf_triangle *leaves, uint32_t count)
{
	struct box box = empty_box();
	for (uint32_t i = 0; i < count; i++) {
		const struct leaf_triangle *l = &leaves[i];
		float min[3], max[3];
		for (int c = 0; c < 3; c++) {
			min[c] = bvh_below(least(l->v0[c], least(l->v1[c], l->v2[c])));
			max[c] = bvh_above(most(l->v0[c], most(l->v1[c], l->v2[c])));
		}
		grow(&box, min, max);
	}
	return box;
}

static struct box box_of_node(const struct bvh_node *node)
{
	struct box box = empty_box();
	grow(&box, node->min0, node->max0);
	grow(&box, node->min1, node->max1);
	return box;
}

static void refit_child(const struct bvh_node *nodes, const struct leaf_triangle *leaves, uint32_t child, uint32_t count,
			float min[3], float max[3])
{
	const struct box box = count > 0 ? box_of_leaf(&leaves[child], count) : box_of_node(&nodes[child]);
	memcpy(min, box.min, sizeof box.min);
	memcpy(max, box.max, sizeof box.max);
}

// A missing child (only the single node of a small scene has one) is a point at infinity.
static bool is_there(const float min[3])
{
	return !isinf(min[0]);
}

void bvh_refit(struct bvh_node *nodes, uint32_t node_count, const struct leaf_triangle *leaves)
{
	// Children have higher numbers than their parents.
	for (uint32_t i = node_count; i-- > 0;) {
		struct bvh_node *n = &nodes[i];
		if (is_there(n->min0))
			refit_child(nodes, leaves, n->child0, n->count0, n->min0, n->max0);
		if (is_there(n->min1))
			refit_child(nodes, leaves, n->child1, n->count1, n->min1, n->max1);
	}
}

static double half_area(const float min[3], const float max[3])
{
	const double x = (double)max[0] - (double)min[0], y = (double)max[1] - (double)min[1],
		     z = (double)max[2] - (double)min[2];
	return x * y + y * z + z * x;
}

double bvh_cost(const struct bvh_node *nodes, uint32_t node_count)
{
	const struct box root = box_of_node(&nodes[0]);
	double sum = 0;
	for (uint32_t i = 0; i < node_count; i++) {
		const struct bvh_node *n = &nodes[i];
		if (is_there(n->min0))
			sum += half_area(n->min0, n->max0) * (1.0 + n->count0);
		if (is_there(n->min1))
			sum += half_area(n->min1, n->max1) * (1.0 + n->count1);
	}
	const double all = is_there(nodes[0].min0) && is_there(nodes[0].min1) ? half_area(root.min, root.max) : 0;
	return all > 0 ? sum / all : 0;
}
