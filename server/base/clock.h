#ifndef CANDIL_BASE_CLOCK_H
#define CANDIL_BASE_CLOCK_H

#include <stdint.h>

// Monotonic time in microseconds, from an arbitrary start.
uint64_t clock_us(void);

#endif
