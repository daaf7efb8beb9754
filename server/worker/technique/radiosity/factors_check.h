// What is known of form factors beforehand: the sum of a row with what escaped and what was cut off is 1, because all light
// of an element goes somewhere, and A_i F_ij = A_j F_ji, reciprocity (Sillion and Puech 1994, "Radiosity and Global
// Illumination", §2.3). How far a matrix keeps to it (factors_project.h makes one that does). On the host: seven seconds of
// one processor for ninety million entries, and on a GPU memory of the host for all of them. Device's thread only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_CHECK_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_CHECK_H

#include <stdbool.h>

#include "server/worker/technique/radiosity/factors_host.h"

#define FACTORS_DECADES 8u

// Of the rows that are looked at. Without any, all is 0.
struct factors_report {
	uint32_t rows;
	uint64_t entries;
	double sum_least, sum_most, sum_mean; // of a row's entries
	double all_least, all_most, all_mean; // the same with what escaped and what was cut off
	double closure_error; // the largest |Σ F + escaped + cut - 1|
	// Of pairs of different elements whose rows both are looked at, and one of which sees the other: |A_i F_ij - A_j
	// F_ji| over the larger of the two, which is 0 … 1, and 1 where one does not see the other. The mean is weighted by
	// the larger.
	uint64_t pairs;
	double reciprocity_most, reciprocity_mean;
	double reciprocity_chance; // what the mean would be about if the rays of each row were independent; 0: not known
	uint64_t decades[FACTORS_DECADES]; // entries of 10^-1 and more, of 10^-2 and more, …; the last: all below
};

// A look at a matrix in slices.
struct factors_check {
	const struct factors *factors;
	const float *area;
	struct factors_host host;
	uint32_t row; // the next
	uint32_t *next;
	double differences, fluxes;
	uint32_t rays; // that a row is a sample of; 0, as after factors_check_init: not known
	double by_chance; // the differences that so many independent rays would make
	bool concluded;
	struct factors_report report; // once it is finished
};

// Begin. `area`: of each element, m². `which`: 1 for the elements whose rows are looked at, as far as they were put; NULL:
// all. Both must outlive the check, and these rows must stay as they are. STATUS_MEMORY.
enum status factors_check_init(struct factors_check *check, const struct factors *factors, const float *area,
			       const uint8_t *which, struct error *err);

// Look at rows for about budget_us, once they are in host memory. STATUS_MEMORY, STATUS_DEVICE.
enum status factors_check_step(struct factors_check *check, uint32_t budget_us, struct error *err);
bool factors_check_finished(const struct factors_check *check);

// Free what it works with; the report stays. Zeroed is fine.
void factors_check_finish(struct factors_check *check);

// All at once, of all rows.
enum status factors_check(const struct factors *factors, const float *area, struct factors_report *report,
			  struct error *err);

#endif
