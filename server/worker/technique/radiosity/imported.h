// What is taken from a file that a request imports (struct plan_imported) in place of being made: rows of form factors, or a
// whole solution. The file lies in the blob of a scene of its own, which jobs hold; what comes of it is copied, so that it
// stays when the file goes. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_IMPORTED_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_IMPORTED_H

#include "server/worker/technique/radiosity/factors.h"

struct elements;
struct plan;
struct plan_imported;
struct resident_scene;
struct solution;

// Whether a plan takes form factors from a file; or a solution.
bool imported_factors(const struct plan *plan);
bool imported_solution(const struct plan *plan);

// Refuse a file of another number of elements: STATUS_BAD_ARGUMENT.
enum status imported_check(const struct plan_imported *imported, const struct elements *elements, struct error *err);

// Rows of form factors.
struct imported_rows;

// Begin to read the rows of a file of these elements, which must outlive them. Fails as imported_check; STATUS_MEMORY.
// imported_rows_destroy frees them.
enum status imported_rows_create(const struct plan_imported *imported, const struct elements *elements,
				 struct imported_rows **rows, struct error *err);
void imported_rows_destroy(struct imported_rows *rows); // NULL is allowed

// Put the file's row of an element. What the row has not is the share that escapes: the file does not tell it apart from
// what a limit of mirrors cut off. Fails as factors_put_row.
enum status imported_rows_put(const struct imported_rows *rows, uint32_t element, struct factors *factors,
			      struct error *err);

// Take the elements of a solution's file from *next on over into the solution, which knows its surfaces, for about
// budget_us; *next is their number once it is done. Of the file are H, D, what light reaches and the shares that leave the
// scene; rows of form factors stay empty. STATUS_BAD_ARGUMENT: places, materials or what they emit and reflect are other
// ones. STATUS_MEMORY, STATUS_DEVICE.
enum status imported_take(struct solution *solution, const struct resident_scene *file, uint32_t *next, uint32_t budget_us,
			  struct error *err);

#endif
