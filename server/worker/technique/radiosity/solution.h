// The light of all elements of a scene, made in slices and kept with it: what surfaces are made of, light straight from
// lights and sky, form factors (factor_build.h), and what the solver finds. It depends on the scene, its materials and
// lights, and on no camera. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLUTION_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_SOLUTION_H

#include "server/worker/image/frame.h"
#include "server/worker/technique/radiosity/display_field.h"
#include "server/worker/technique/radiosity/factor_build.h"
#include "server/worker/technique/radiosity/factors_check.h"

struct surfaces;
struct light;
struct solver;
struct corner_values;

// What it depends on beside the scene. Compared byte by byte: zero it before filling it in.
struct solution_options {
	struct factor_options factors;
	uint32_t effects; // bits 1 << candil_Effect
	uint32_t points, sky_points; // of a patch, from which lights and the sky are looked at
	uint32_t emitters; // enum radiosity_emitters
	uint32_t project; // enum radiosity_project; 0: not at all
	uint32_t solver; // enum solver_way
	float residual; // the solver ends there
	float background[3]; // radiance, W/(m² sr)
	uint64_t sky; // id of the environment's scene; 0: none
	float sky_turn, sky_scale;
};

// The stages of making it, in this order.
enum solution_stage {
	SOLUTION_SURFACES,
	SOLUTION_IMPORT, // of one that is taken from a file, in place of light, factors and solving
	SOLUTION_LIGHT,
	SOLUTION_FACTORS,
	SOLUTION_PROJECT,
	SOLUTION_SOLVE,
	SOLUTION_CORNERS,
	SOLUTION_DONE,
	SOLUTION_STAGES
};

// A solution.
struct solution {
	struct shelved shelved;
	struct solution_options options;
	struct scene_keys keys;
	struct device *device;
	struct resident_scene *scene; // the variant that it is made from; read only until it is done
	struct resident_scene *imported; // the file that it, or its factors, are taken from, likewise; NULL: none
	bool taken; // the file is a solution
	uint32_t taken_next; // element of it that is taken next
	struct factor_build *factors; // held
	struct element_buffers buffers; // those of `factors`, and surfaces of its own
	enum solution_stage stage;
	struct surfaces *surfaces; // until it is done
	struct light *light; // until it is done; NULL: the scene has none
	struct row_maker *rows_by; // until it is done
	struct reach reach; // until its rows are there
	bool lamps; // light of emissive surfaces comes straight from them, and not by form factors
	struct solution_projecting *projecting; // in its stage
	struct solver *solver; // until it is done
	struct corner_values *at_corners; // until it is done
	// By element, in host memory.
	struct radiosity_surface *made_of;
	float *direct; // irradiance straight from lights and sky, W/m², 3 each
	float *irradiance; // all of it
	float *corners; // irradiance at its four corners, 12 each
	struct factors projected; // the rows that its light reaches, by options.project; zero without
	uint8_t
	    *reached; // 1: its light reaches the element (reach.h), whatever other rows are kept; once its rows are there
	struct display_field fields[2]; // for pictures (solution_field): by element, by corner; zeroed: not asked for
	struct factors_report report; // on the rows of those elements
	double projected_reciprocity; // the mean of the projected rows
	bool reported; // they are there
	double residual;
	uint32_t iterations;
	uint64_t rows; // of form factors that were made for it
	uint64_t stage_us[SOLUTION_STAGES]; // host time of its stages
	uint64_t compile_us;
};

// Whether light of emissive surfaces is looked for by points on them.
bool solution_finds_lamps(const struct solution_options *options, const struct resident_scene *scene);

// Whether there is a solution by these options whose making is over.
bool solution_is_made(struct resident_scene *scene, const struct solution_options *options);

// Hold the solution of a scene by these options, beginning a new one if there is none for the same places, materials and
// lights. A new one compiles its code. Pair with solution_release. STATUS_MEMORY, STATUS_DEVICE, and as patches_init.
enum status solution_acquire(struct resident_scene *scene, struct device *device, struct gl_device *gl,
			     const struct plan *plan, const struct solution_options *options, struct solution **solution,
			     struct error *err);
void solution_release(struct solution *solution); // NULL is allowed

// Work on it for about budget_us, at least one piece. STATUS_BAD_ARGUMENT: there is no solution (solver.h).
// STATUS_TRAVERSAL_CUT: the driver ended the loops of an element's rays early.
enum status solution_step(struct solution *solution, uint32_t budget_us, struct error *err);

// Whether its making is over, and the share of it that is done, 0…1.
bool solution_finished(const struct solution *solution);
double solution_fraction(const struct solution *solution);

// Whether an element shines, or light straight from a lamp or the sky is on it. A background is behind anything. Of a
// solution that knows its direct light.
bool solution_is_lit(const struct solution *solution, uint32_t element);

// The irradiance of a finished one for pictures, by element or at corners, uploaded when it is first asked for: another
// camera finds it there. *field stays the solution's. STATUS_MEMORY, STATUS_DEVICE.
enum status solution_field(struct solution *solution, struct gl_device *gl, bool corners, const struct display_field **field,
			   struct error *err);

// The form factors that it is solved with.
static inline const struct factors *solution_matrix(const struct solution *solution)
{
	return solution->options.project ? &solution->projected : &solution->factors->factors;
}

// Begin to solve, once all but H is known; with a `start` as in struct solver_problem. The solver is the caller's, whose
// solution must outlive it. Fails as solver_create.
enum status solution_create_solver(const struct solution *solution, const float *start, struct solver **solver,
				   struct error *err);

// Add its figures to a frame's account, and its stages' times where the frame's job has made it.
void solution_account(const struct solution *solution, bool made, struct frame *frame);

// Host time that compiling its code took, once: 0 at every later call.
uint64_t solution_take_compile_us(struct solution *solution);

#endif
