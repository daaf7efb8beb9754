// What is known of a picture's error: its relMSE, mean((x − r)² / (r² + 0.01)) over pixels and channels, where x is the
// picture and r what it would be with samples without end. A value; any thread.
#ifndef CANDIL_BASE_ESTIMATE_H
#define CANDIL_BASE_ESTIMATE_H

#include "candil.pb.h"

struct estimate {
	double relmse; // the likeliest value; negative: nothing is known, and the ends say nothing
	double low, high; // nine times of ten the true one lies between; high is negative where there is no upper end,
			  // because light may be there that no sample has found
	candil_ErrorKind kind; // how it is known; unknown if and only if relmse is negative
};

#define ESTIMATE_UNKNOWN ((struct estimate){.relmse = -1, .low = -1, .high = -1})

#endif
