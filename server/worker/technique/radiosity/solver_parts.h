// The inside of solver.h, for the files solver*.c.
//
// All three ways look for the irradiance H with H = D + F (M + ρ H). They work on what H still lacks: with
//	r = D + F (M + ρ H) - H
// the change e that satisfies e = r + F ρ e makes H right. So a solver alternates between two things. The outer step adds e
// to H, which is kept as pairs of floats, and finds r, with sums as pairs (shaders/radiosity/pairs.glsl): r is right to some
// 10⁻¹¹ of H. The inner iteration finds e in plain floats, in units in which the largest r is about 1, until floats can show
// no more of it or less is asked for. This is iterative refinement (Wilkinson 1963, "Rounding Errors in Algebraic
// Processes"): the ways agree however much a reflectance near 1 amplifies the rounding of floats, and the inner sums can be
// fast ones.
//
// Jacobi and Gauss-Seidel iterate e ← r + F ρ e, Gauss-Seidel in SOLVER_PARTS parts of the elements, each with what the
// parts before it have found. Within a part all elements are as in Jacobi's iteration, so that no order of threads is seen.
//
// The gradient way needs a symmetric system. By reciprocity A_i F_ij = A_j F_ji, so F ρ is symmetric in the inner product
// <x, y> = Σ A_i ρ_i x_i y_i: its matrix there is A ρ F ρ. An element with ρ = 0 has no weight in it, and the iterations
// carry it along without asking it; no root or quotient of ρ is taken. Factors found by sampling are reciprocal but for
// noise. So that noise costs iterations and not the answer, the system is not replaced by one with averaged factors; instead
// the conjugate gradients are those that minimise the residual (conjugate residuals: Stiefel 1955), started again by every
// outer step, with the true r. Their residual never grows while the symmetric part of 1 - F ρ is positive definite. Where it
// does not fall either, Jacobi's iteration takes over.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLVER_PARTS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLVER_PARTS_H

#include "server/worker/technique/radiosity/solver.h"
#include "server/worker/vk/pipeline.h"
#include "shaders/shared/solve.h"

#define SOLVER_PARTS 32u // of Gauss-Seidel's iteration

// Rows that one dispatch can take: of one part of the elements, in one block of the matrix.
struct solver_run {
	uint32_t part, block;
	uint32_t first, end; // of the list of rows
};

// What a solver does next.
enum solver_stage {
	SOLVER_TEST, // whether there is a solution: powers of ρ F
	SOLVER_OUTER,
	SOLVER_RELAX, // inner, Jacobi or Gauss-Seidel
	SOLVER_AIM, // inner, conjugate gradients
	SOLVER_DONE,
};

// A solver.
struct solver {
	struct device *device;
	const struct factors *factors;
	uint32_t count; // elements
	enum solver_way way;
	double target;
	uint32_t limit;
	// Rows with entries, by run and element.
	struct solve_row *list;
	uint32_t listed;
	struct solver_run *runs;
	uint32_t run_count, parts;
	// Device.
	struct buffer rows, maxima, maxima_host, partials;
	struct buffer albedo, exitance, irradiance, field, source, sums, residual, change, direction, image;
	uint32_t partial_count;
	struct pipeline *gather[2]; // plain, and pairs
	struct pipeline *steps[STEP_COUNT]; // NULL: this way has none
	struct binding_set *gather_sets[2]; // by block
	uint32_t gather_blocks; // of the matrix when the sets were made: others may add some
	struct binding_set step_sets[STEP_COUNT];
	// The product under way.
	bool sweeping;
	uint32_t run, row; // next
	double entry_us[2]; // 0: not measured yet
	// The solution.
	enum solver_stage stage;
	uint32_t iterations; // products with F
	double told; // solver_residual
	bool extra; // H lacks e: it is in the midst of an inner iteration; else it lacks r
	double scale[3]; // of e and r in an inner iteration
	double bright[3]; // largest B at the last outer step, or largest first change
	double outer; // residual at the last outer step
	uint32_t stalled; // outer steps that brought little
	uint32_t tests; // powers of SOLVER_TEST so far
	uint32_t testing; // what a product is for: TEST_REACHED, TEST_POWER; TEST_ONES at first
	bool lit; // the powers are those of where light is
	uint32_t passed; // bits of channels
	double length[3]; // <q, q>
	double mark[3]; // <r, r> some gradients before
	uint32_t gradients; // since the outer step
};

// ---- solver_device.c
// ------------------------------------------------------------------------------------------------------

// Make the list of rows, all buffers and what is bound. STATUS_MEMORY, STATUS_DEVICE; solver_device_finish frees what there
// is.
enum status solver_device_init(struct solver *s, const struct solver_problem *problem, struct error *err);
void solver_device_finish(struct solver *s);

// Record a pass over elements [first, end) and a barrier behind it.
void solver_record_step(const struct solver *s, uint32_t step, uint32_t first, uint32_t end, const double scale[4]);

// Record setting the maxima to 0, or copying them to the host, each with a barrier.
void solver_clear_maxima(const struct solver *s);
void solver_fetch_maxima(const struct solver *s);

// A maximum that was fetched.
double solver_maximum(const struct solver *s, uint32_t which, int channel);

// The sum over all elements of a part that the last pass has left.
double solver_sum(const struct solver *s, uint32_t which, int channel);

// ---- solver_sweep.c
// -------------------------------------------------------------------------------------------------------

// Work on a product with F for about budget_us. Before the first piece of it, STEP `before` runs, and after the last `after`
// (STEP_COUNT: none), and the maxima are fetched; *done then. With STEP_RELAX as `after`, that follows each part instead.
enum status solver_sweep(struct solver *s, bool pairs, uint32_t before, uint32_t after, const double scale[4],
			 uint32_t budget_us, bool *done, struct error *err);

// ---- solver_gradient.c
// ----------------------------------------------------------------------------------------------------

// A product for conjugate gradients is done: aim and move. *stuck: their residual no longer falls.
enum status solver_gradient(struct solver *s, bool *stuck, struct error *err);

#endif
