// What is known of form factors beforehand: the sum of a row with what escaped and what was cut off is 1, because all light
// of an element goes somewhere, and A_i F_ij = A_j F_ji, reciprocity (Sillion and Puech 1994, "Radiosity and Global
// Illumination", §2.3). How far a matrix keeps to it, and projections onto matrices that do. On the host, all at once: seven
// seconds of one processor for ninety million entries, and on a GPU memory of the host for all of them. Device's thread
// only.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_CHECK_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_CHECK_H

#include "server/worker/technique/radiosity/factors.h"

// Of the rows that were put. Without any, all is 0.
struct factors_report {
	uint32_t rows;
	uint64_t entries;
	double sum_least, sum_most, sum_mean; // of a row's entries
	double closure_error; // the largest |Σ F + escaped + cut - 1|
	// Of pairs of different elements whose rows both were put, and one of which sees the other: |A_i F_ij - A_j F_ji|
	// over the larger of the two, which is 0 … 1, and 1 where one does not see the other. The mean is weighted by the
	// larger.
	uint64_t pairs;
	double reciprocity_most, reciprocity_mean;
};

// Measure. `area`: of each element, m². STATUS_MEMORY, STATUS_DEVICE.
enum status factors_check(const struct factors *factors, const float *area, struct factors_report *report,
			  struct error *err);

// Scale every row so that Σ F + escaped + cut = 1. A row without entries stays as it is. STATUS_MEMORY, STATUS_DEVICE: some
// rows may be scaled.
enum status factors_close(struct factors *factors, struct error *err);

// Replace A_i F_ij and A_j F_ji by their mean, wherever both rows were put. Rows get the entries that only the other had.
// Their sums change: factors_close may follow, and undoes a part of it. Needs memory for the matrix old and new.
// STATUS_MEMORY, STATUS_DEVICE: the matrix is as it was.
enum status factors_average(struct factors *factors, const float *area, struct error *err);

#endif
