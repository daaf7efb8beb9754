// Gauss and Legendre's rules on [-1, 1]: a rule of n points has no error in polynomials up to the degree 2 n - 1. Any
// thread; nothing fails.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_GAUSS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_GAUSS_H

#include <stdbool.h>
#include <stdint.h>

// A rule of an even number of points: the half of them above zero, the outermost first.
struct gauss_rule {
	uint32_t points;
	double node[6], weight[6];
};

// The rules of 2, 4, 6 and 12 points.
static const struct gauss_rule gauss_2 = {2, {0.577350269189625765}, {1}},
			       gauss_4 = {4,
					  {0.861136311594052575, 0.339981043584856265},
					  {0.347854845137453857, 0.652145154862546143}},
			       gauss_6 = {6,
					  {0.932469514203152028, 0.661209386466264514, 0.238619186083196909},
					  {0.171324492379170345, 0.360761573048138608, 0.467913934572691047}},
			       gauss_12 = {12,
					   {0.981560634246719251, 0.904117256370474857, 0.769902674194304687,
					    0.587317954286617447, 0.367831498998180194, 0.125233408511468915},
					   {0.0471753363865118272, 0.106939325995318431, 0.160078328543346226,
					    0.203167426723065922, 0.233492536538354809, 0.249147045813402785}};

// The node of a point, and its weight.
static inline double gauss_node(const struct gauss_rule *rule, uint32_t i, double *weight)
{
	const bool back = i >= rule->points / 2;
	const uint32_t k = back ? rule->points - 1 - i : i;
	*weight = rule->weight[k];
	return back ? rule->node[k] : -rule->node[k];
}

#endif
