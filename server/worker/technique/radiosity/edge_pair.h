// ∫∫ ln r of two straight edges: what the form factor of two polygons is a sum of (form_factor.h). The integral along the
// longer edge is elementary; the one along the shorter is by Gauss rules, on pieces that become smaller where the edges
// touch, meet or cross. Any thread; nothing fails.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_EDGE_PAIR_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_EDGE_PAIR_H

// A straight edge of a length above zero, in units of which extents are about 1.
struct edge {
	double from[3], along[3]; // along: unit
	double length;
};

// A number, and a bound of its error.
struct bounded {
	double value, error;
};

// ∫∫ ln (r / unit) dp · dq, along both edges. Around a closed contour the choice of `unit` changes nothing but the size of
// the terms: it is best near the typical distance.
struct bounded edge_pair(const struct edge *p, const struct edge *q, double unit);

#endif
