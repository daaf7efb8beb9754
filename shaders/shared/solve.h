// Solving for the light of all elements of radiosity (server/worker/technique/radiosity/solver_parts.h says how). Shared by
// C and GLSL.
#ifndef CANDIL_SHARED_SOLVE_H
#define CANDIL_SHARED_SOLVE_H

#include "shared/bindings.h"

#define SOLVE_LANES 64 // of a workgroup

// ---- sums over the rows of a block of the matrix: radiosity/solve_gather.comp.glsl
// ------------------------------------------

// Texel buffers, four words a texel.
#define BIND_GATHER_COLUMNS 0 // of the block
#define BIND_GATHER_VALUES 1 // of the block
#define BIND_GATHER_SOURCE 2 // what is summed: a texel for each element, or two with SPEC_GATHER_PAIRS
#define BIND_GATHER_ROWS 3 // struct solve_row
#define BIND_GATHER_SUMS 4 // two vec4 for each element: the sum, and with SPEC_GATHER_PAIRS what it lacks
#define BIND_GATHER_COUNT 5

#define SPEC_GATHER_PAIRS SPEC_PASS // sums are pairs of floats: radiosity/pairs.glsl

// A row with entries.
struct solve_row {
	uint element;
	uint first, count; // entries of the block
};
LAYOUT_ASSERT(solve_row, 12)

struct gather_push {
	uint first_row, end_row;
};
LAYOUT_ASSERT(gather_push, 8)

// ---- arithmetic element by element: radiosity/solve_step.comp.glsl
// ----------------------------------------------------------

// Arrays of a vec4 for each element, a float a channel, if nothing else is said.
#define BIND_STEP_ALBEDO 0 // ρ; w: area over the largest
#define BIND_STEP_EXITANCE 1 // M
#define BIND_STEP_IRRADIANCE 2 // D
#define BIND_STEP_FIELD 3 // H as pairs: two vec4
#define BIND_STEP_SOURCE 4 // BIND_GATHER_SOURCE
#define BIND_STEP_SUMS 5 // BIND_GATHER_SUMS
#define BIND_STEP_RESIDUAL 6 // r
#define BIND_STEP_CHANGE 7 // e, an estimate of what H lacks
#define BIND_STEP_DIRECTION 8 // p
#define BIND_STEP_IMAGE 9 // q = (1 - F ρ) p
#define BIND_STEP_MAXIMA 10 // uint: bits of SOLVE_MAXIMA times 3 floats
#define BIND_STEP_PARTS 11 // two vec4 for each subgroup: parts of sums over the elements
#define BIND_STEP_COUNT 12

#define SOLVE_MAXIMA 3

// The passes, values of SPEC_STEP: solve_step.comp.glsl says what each does.
#define SPEC_STEP SPEC_PASS
#define STEP_FOLD 0u
#define STEP_RESIDUAL 1u
#define STEP_START 2u
#define STEP_RELAX 3u
#define STEP_AIM 4u
#define STEP_MOVE 5u
#define STEP_TURN 6u
#define STEP_TEST 7u
#define STEP_COUNT 8

// What STEP_TEST does, its fourth scale.
#define TEST_ONES 0
#define TEST_LIT 1
#define TEST_REACHED 2
#define TEST_POWER 3

struct step_push {
	float scale[4]; // of each channel
	uint first, end; // elements
};
LAYOUT_ASSERT(step_push, 24)

#endif
