// Solves for the light of all elements on the device: B = M + ρ H, H = D + F B, in each of three channels, which share F.
// B is radiosity, M emitted exitance, D irradiance straight from lights that are no elements, H irradiance, all W/m²; ρ is
// diffuse reflectance. Vulkan; device's thread only. A solution is the same to the bit whatever the slices.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLVER_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLVER_H

#include "server/worker/technique/radiosity/factors.h"

// The words of radiosity.solver.
enum solver_way {
	SOLVER_GRADIENT, // conjugate gradients on the system that is symmetric by reciprocity (solver_parts.h)
	SOLVER_JACOBI, // H ← D + F B of the iteration before
	SOLVER_GAUSS_SEIDEL, // the same block by block of rows, each with what those before it have found
};

// What is to be solved. The arrays are the caller's, 3 floats for each element, and are copied.
struct solver_problem {
	const struct factors *factors; // must outlive the solver
	const uint8_t *which; // 1 for the elements whose rows count, which see no others; the rest stays dark. NULL: all
	const float *exitance; // M
	const float *albedo; // ρ
	const float *irradiance; // D
	const float *area; // of each element, m²
	enum solver_way way;
	double residual; // end once ρ (D + F B - H), over the largest B, is at most this in every channel
	uint32_t iterations; // that it may take: products with F, without those that test whether there is a solution
	const float *start; // NULL; or an H, of which only the residual is found, by one product (solver_read_residual)
};

struct solver;

// Compile what a way needs, where that was not done before. STATUS_MEMORY, STATUS_DEVICE.
enum status solver_compile(struct device *device, enum solver_way way, struct error *err);

// Begin; it compiles what solver_compile did not. STATUS_BAD_ARGUMENT: a number is negative or none. STATUS_MEMORY,
// STATUS_DEVICE. The matrix must stay as it is while the solver lives.
enum status solver_create(const struct solver_problem *problem, struct device *device, struct solver **solver,
			  struct error *err);
void solver_destroy(struct solver *solver);

// Work for about budget_us, at least one piece. STATUS_BAD_ARGUMENT: ρ times the row sums of F is 1 or more in a room that
// light comes to and nothing leaves, so that there is no solution; the sentence says so. A ρ of 1 is no such thing where
// light gets away or is absorbed elsewhere, or where none is.
enum status solver_step(struct solver *solver, uint32_t budget_us, struct error *err);

// Device memory that a solver of so many elements takes, in bytes.
uint64_t solver_bytes(uint32_t elements);

// Whether it has ended, and what it has come to.
bool solver_finished(const struct solver *solver);
double solver_residual(const struct solver *solver); // so far: above the one asked for if it ended without reaching it
uint32_t solver_iterations(const struct solver *solver); // done

// Copy H to host memory, 3 floats for each element. Before the end it is what has been found so far.
enum status solver_read(const struct solver *solver, float *irradiance, struct error *err);

// Copy B - M - ρ (D + F B) of the `start` that it began with, 3 floats for each element, once it has ended. It is right to
// some 10⁻¹¹ of B.
enum status solver_read_residual(const struct solver *solver, float *residual, struct error *err);

#endif
