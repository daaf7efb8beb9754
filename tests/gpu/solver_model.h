// Systems of radiosity with known solutions, for tests of its solvers: dense matrices in host memory.
#ifndef CANDIL_TESTS_GPU_SOLVER_MODEL_H
#define CANDIL_TESTS_GPU_SOLVER_MODEL_H

#include "server/worker/technique/radiosity/solver.h"

// A system; its arrays are its own.
struct system {
	uint32_t count;
	float *matrix; // F, by row and column
	float *exitance, *albedo, *irradiance; // 3 for each element
	float *area;
};

// A word from a fixed sequence, and a number 0…1.
uint32_t model_draw(void);
double model_draw_unit(void);
void model_seed(uint32_t seed);

// All zero but the areas, which are 1. Asserts that there is memory.
struct system system_make(uint32_t count);
void system_free(struct system *s);

// The inside of a sphere in `count` elements of different areas, from element `first` on: F_ij = A_j / Σ A exactly.
void system_add_sphere(struct system *s, uint32_t first, uint32_t count);

// A random matrix that obeys reciprocity but for rounding, about one entry in `sparse`, the row sums 0.4 to 0.95; and areas,
// reflectances from 0 (in one element of five) to `most`, exitances and irradiances, different in all channels.
void system_fill(struct system *s, uint32_t sparse, double most);

// Put the matrix into device memory, in blocks of `block_entries` at most (0: as usual).
void system_put(const struct system *s, struct device *device, uint32_t block_entries, struct factors *factors);

// The irradiances by LU decomposition in double.
void system_solve(const struct system *s, double *irradiance);

// How many of a solver's products it took, what residual it told, and what it found.
struct solved {
	enum status status;
	uint32_t iterations;
	double residual;
	float *irradiance;
	struct error err;
};

// Solve on the device. Asserts that nothing fails but what struct solved tells.
struct solved system_run(const struct system *s, const struct factors *factors, struct device *device, enum solver_way way,
			 double residual, uint32_t iterations, uint32_t budget_us);

// The largest error of B = M + ρ H, relative to its own size, over all elements and channels.
double system_error(const struct system *s, const float *found, const double *right);

#endif
