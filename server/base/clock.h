#ifndef CANDIL_BASE_CLOCK_H
#define CANDIL_BASE_CLOCK_H

#include <stdint.h>

// Monotonic time in microseconds since an arbitrary start. Any thread; cannot fail.
uint64_t clock_us(void);

#endif
