#include "server/loader/bvh.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "server/scene/bvh_refit.h"

// A node of the tree before flattening. It is a leaf if count > 0.
struct tree {
	struct bvh_node node; // boxes of the children; flattening fills in their numbers
	struct tree *child[2];
	uint32_t count;
	uint32_t ids[BVH_LEAF_TRIANGLES];
};

// A missing child is a point at infinity, which every ray misses.
static const struct bvh_node no_children = {
    .min0 = {INFINITY, INFINITY, INFINITY},
    .max0 = {INFINITY, INFINITY, INFINITY},
    .min1 = {INFINITY, INFINITY, INFINITY},
    .max1 = {INFINITY, INFINITY, INFINITY},
};

static void grow_box(float min[3], float max[3], const struct RTCBuildPrimitive *p)
{
	min[0] = fminf(min[0], p->lower_x);
	min[1] = fminf(min[1], p->lower_y);
	min[2] = fminf(min[2], p->lower_z);
	max[0] = fmaxf(max[0], p->upper_x);
	max[1] = fmaxf(max[1], p->upper_y);
	max[2] = fmaxf(max[2], p->upper_z);
}

// Boxes are minima and maxima of the vertices' own floats, moved outwards (bvh_refit.h).
static struct RTCBuildPrimitive *make_primitives(const struct vertex *vertices, const struct triangle *triangles,
						 uint32_t count)
{
	struct RTCBuildPrimitive *out = aligned_alloc(32, ((size_t)count + 1) * sizeof *out);
	for (uint32_t i = 0; i < count && out; i++) {
		const float *a = vertices[triangles[i].vertex[0]].position, *b = vertices[triangles[i].vertex[1]].position,
			    *c = vertices[triangles[i].vertex[2]].position;
		out[i] = (struct RTCBuildPrimitive){
		    .lower_x = bvh_below(fminf(a[0], fminf(b[0], c[0]))),
		    .lower_y = bvh_below(fminf(a[1], fminf(b[1], c[1]))),
		    .lower_z = bvh_below(fminf(a[2], fminf(b[2], c[2]))),
		    .upper_x = bvh_above(fmaxf(a[0], fmaxf(b[0], c[0]))),
		    .upper_y = bvh_above(fmaxf(a[1], fmaxf(b[1], c[1]))),
		    .upper_z = bvh_above(fmaxf(a[2], fmaxf(b[2], c[2]))),
		    .primID = i,
		};
	}
	return out;
}

// ---- Embree's callbacks -------------------------------------------------------------------------------------------------

static void *create_node(RTCThreadLocalAllocator allocator, unsigned count, void *user)
{
	(void)count, (void)user;
	struct tree *t = rtcThreadLocalAlloc(allocator, sizeof *t, 16);
	*t = (struct tree){.node = no_children};
	return t;
}

static void set_children(void *node, void **children, unsigned count, void *user)
{
	struct tree *t = node;
	(void)user;
	for (unsigned i = 0; i < count && i < 2; i++)
		t->child[i] = children[i];
}

static void set_bounds(void *node, const struct RTCBounds **bounds, unsigned count, void *user)
{
	struct bvh_node *n = &((struct tree *)node)->node;
	(void)user;
	if (count != 2)
		return;
	memcpy(n->min0, &bounds[0]->lower_x, sizeof n->min0);
	memcpy(n->max0, &bounds[0]->upper_x, sizeof n->max0);
	memcpy(n->min1, &bounds[1]->lower_x, sizeof n->min1);
	memcpy(n->max1, &bounds[1]->upper_x, sizeof n->max1);
}

static void fill_leaf(struct tree *t, const struct RTCBuildPrimitive *primitives, size_t count)
{
	*t = (struct tree){.count = (uint32_t)count};
	for (size_t i = 0; i < count; i++) {
		size_t at = i;
		// Triangles are sorted by id, because the builder's order is not guaranteed.
		for (; at > 0 && t->ids[at - 1] > primitives[i].primID; at--)
			t->ids[at] = t->ids[at - 1];
		t->ids[at] = primitives[i].primID;
	}
}

static void *create_leaf(RTCThreadLocalAllocator allocator, const struct RTCBuildPrimitive *primitives, size_t count,
			 void *user)
{
	(void)user;
	struct tree *t = rtcThreadLocalAlloc(allocator, sizeof *t, 16);
	fill_leaf(t, primitives, count < BVH_LEAF_TRIANGLES ? count : BVH_LEAF_TRIANGLES);
	return t;
}

static struct tree *build_by_embree(RTCBVH bvh, struct RTCBuildPrimitive *primitives, uint32_t count)
{
	struct RTCBuildArguments a = rtcDefaultBuildArguments();
	a.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
	a.maxBranchingFactor = 2;
	a.maxDepth = LIMIT_BVH_DEPTH;
	a.maxLeafSize = BVH_LEAF_TRIANGLES;
	a.bvh = bvh;
	a.primitives = primitives;
	a.primitiveCount = count;
	a.primitiveArrayCapacity = count;
	a.createNode = create_node;
	a.setNodeChildren = set_children;
	a.setNodeBounds = set_bounds;
	a.createLeaf = create_leaf;
	return rtcBuildBVH(&a);
}

// ---- the balanced builder -----------------------------------------------------------------------------------------------

static double centre_of(const struct RTCBuildPrimitive *p, int axis)
{
	return axis == 0   ? (double)p->lower_x + (double)p->upper_x
	       : axis == 1 ? (double)p->lower_y + (double)p->upper_y
			   : (double)p->lower_z + (double)p->upper_z;
}

static int compare_on(const void *a, const void *b, int axis)
{
	const struct RTCBuildPrimitive *p = a, *q = b;
	const double u = centre_of(p, axis), v = centre_of(q, axis);
	return u < v ? -1 : u > v ? 1 : p->primID < q->primID ? -1 : p->primID > q->primID;
}

static int compare_x(const void *a, const void *b)
{
	return compare_on(a, b, 0);
}

static int compare_y(const void *a, const void *b)
{
	return compare_on(a, b, 1);
}

static int compare_z(const void *a, const void *b)
{
	return compare_on(a, b, 2);
}

static void box_of(const struct RTCBuildPrimitive *primitives, size_t count, float min[3], float max[3])
{
	for (int i = 0; i < 3; i++) {
		min[i] = INFINITY;
		max[i] = -INFINITY;
	}
	for (size_t i = 0; i < count; i++)
		grow_box(min, max, &primitives[i]);
}

// The recursion is log2(count) deep.
static struct tree *build_balanced(struct RTCBuildPrimitive *primitives, size_t count, struct tree **next)
{
	static int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
	struct tree *t = (*next)++;
	float min[3], max[3];

	if (count <= BVH_LEAF_TRIANGLES) {
		fill_leaf(t, primitives, count);
		return t;
	}
	box_of(primitives, count, min, max);
	int axis = max[1] - min[1] > max[0] - min[0] ? 1 : 0;
	axis = max[2] - min[2] > max[axis] - min[axis] ? 2 : axis;
	qsort(primitives, count, sizeof *primitives, compare[axis]);
	const size_t half = count / 2;
	*t = (struct tree){.node = no_children};
	box_of(primitives, half, t->node.min0, t->node.max0);
	box_of(primitives + half, count - half, t->node.min1, t->node.max1);
	t->child[0] = build_balanced(primitives, half, next);
	t->child[1] = build_balanced(primitives + half, count - half, next);
	return t;
}

// ---- flattening ---------------------------------------------------------------------------------------------------------

// Count the nodes, the depth and the triangles. False if the tree is too deep or does not hold each triangle once.
static bool measure(const struct tree *t, uint32_t level, uint32_t *nodes, uint32_t *depth, uint32_t *leaves)
{
	if (!t)
		return false;
	if (t->count > 0) {
		*leaves += t->count;
		return true;
	}
	if (level > LIMIT_BVH_DEPTH)
		return false;
	++*nodes;
	if (level > *depth)
		*depth = level;
	return measure(t->child[0], level + 1, nodes, depth, leaves) &&
	       measure(t->child[1], level + 1, nodes, depth, leaves);
}

struct cursor {
	struct bvh *bvh;
	uint32_t node;
	uint32_t leaf;
};

static uint32_t put_leaf(struct cursor *c, const struct tree *t)
{
	const uint32_t first = c->leaf;
	memcpy(c->bvh->order + first, t->ids, t->count * sizeof *t->ids);
	c->leaf += t->count;
	return first;
}

static uint32_t put_node(struct cursor *c, const struct tree *t)
{
	const uint32_t at = c->node++;
	struct bvh_node *n = &c->bvh->nodes[at];
	*n = t->node;
	n->count0 = t->child[0]->count;
	n->child0 = n->count0 > 0 ? put_leaf(c, t->child[0]) : put_node(c, t->child[0]);
	n->count1 = t->child[1]->count;
	n->child1 = n->count1 > 0 ? put_leaf(c, t->child[1]) : put_node(c, t->child[1]);
	return at;
}

static enum status allocate(struct bvh *out, uint32_t nodes, uint32_t count, struct error *err)
{
	out->nodes = malloc(nodes * sizeof *out->nodes);
	out->order = malloc(((size_t)count + 1) * sizeof *out->order);
	out->node_count = nodes;
	if (out->nodes && out->order)
		return STATUS_OK;
	bvh_finish(out);
	return error_set(err, STATUS_MEMORY, "no memory for a BVH over %u triangles", count);
}

// STATUS_UNSUPPORTED if the tree is too deep.
static enum status flatten(const struct tree *root, uint32_t count, struct bvh *out, struct error *err)
{
	uint32_t nodes = 0, depth = 0, leaves = 0;
	if (!measure(root, 1, &nodes, &depth, &leaves) || leaves != count)
		return STATUS_UNSUPPORTED;
	if (allocate(out, nodes, count, err) != STATUS_OK)
		return err->code;
	struct cursor c = {.bvh = out};
	out->depth = depth;
	put_node(&c, root);
	return STATUS_OK;
}

// A scene of a single leaf: one node, whose children share the triangles if there are at least two.
static enum status build_tiny(const struct RTCBuildPrimitive *primitives, uint32_t count, struct bvh *out, struct error *err)
{
	if (allocate(out, 1, count, err) != STATUS_OK)
		return err->code;
	const uint32_t half = (count + 1) / 2;
	struct bvh_node *n = &out->nodes[0];
	*n = no_children;
	out->depth = 1;
	for (uint32_t i = 0; i < count; i++)
		out->order[i] = i;
	n->count0 = half;
	n->count1 = count - half;
	if (n->count0 > 0)
		box_of(primitives, half, n->min0, n->max0);
	if (n->count1 > 0)
		box_of(primitives + half, count - half, n->min1, n->max1);
	n->child1 = n->count1 > 0 ? half : 0;
	return STATUS_OK;
}

static enum status flatten_balanced(struct RTCBuildPrimitive *primitives, uint32_t count, struct bvh *out, struct error *err)
{
	struct tree *trees =
	    malloc((size_t)count * sizeof *trees); // leaves hold at least two triangles: fewer nodes than triangles
	if (!trees)
		return error_set(err, STATUS_MEMORY, "no memory for a BVH over %u triangles", count);
	struct tree *next = trees;
	enum status status = flatten(build_balanced(primitives, count, &next), count, out, err);
	free(trees);
	return status == STATUS_UNSUPPORTED ? error_set(err, STATUS_INTERNAL, "the BVH came out too deep") : status;
}

static enum status flatten_embree(struct RTCBuildPrimitive *primitives, uint32_t count, struct bvh *out, struct error *err)
{
	// One thread, because with several the order in which they finish would affect the tree.
	RTCDevice device = rtcNewDevice("threads=1,verbose=0");
	RTCBVH bvh = device ? rtcNewBVH(device) : NULL;
	const struct tree *root = bvh ? build_by_embree(bvh, primitives, count) : NULL;
	enum status status = root ? flatten(root, count, out, err) : STATUS_UNSUPPORTED;
	if (bvh)
		rtcReleaseBVH(bvh);
	if (device)
		rtcReleaseDevice(device);
	return status;
}

enum status bvh_build_balanced(const struct vertex *vertices, const struct triangle *triangles, uint32_t count,
			       struct bvh *out, struct error *err)
{
	struct RTCBuildPrimitive *primitives = make_primitives(vertices, triangles, count);
	*out = (struct bvh){0};
	if (!primitives)
		return error_set(err, STATUS_MEMORY, "no memory for a BVH over %u triangles", count);
	enum status status = count <= BVH_LEAF_TRIANGLES ? build_tiny(primitives, count, out, err)
							 : flatten_balanced(primitives, count, out, err);
	free(primitives);
	return status;
}

enum status bvh_build(const struct vertex *vertices, const struct triangle *triangles, uint32_t count, struct bvh *out,
		      struct error *err)
{
	*out = (struct bvh){0};
	if (count <= BVH_LEAF_TRIANGLES)
		return bvh_build_balanced(vertices, triangles, count, out, err);
	struct RTCBuildPrimitive *primitives = make_primitives(vertices, triangles, count);
	if (!primitives)
		return error_set(err, STATUS_MEMORY, "no memory for a BVH over %u triangles", count);
	enum status status = flatten_embree(primitives, count, out, err);
	free(primitives);
	return status == STATUS_UNSUPPORTED ? bvh_build_balanced(vertices, triangles, count, out, err) : status;
}

void bvh_finish(struct bvh *bvh)
{
	free(bvh->nodes);
	free(bvh->order);
	*bvh = (struct bvh){0};
}
