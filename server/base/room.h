// Address space under a limit of it (RLIMIT_AS: `ulimit -v`, systemd's LimitAS=). Drivers, their compilers and image
// libraries crash where it ends, so whoever is about to use them asks first. Without a limit there is always room. Any
// thread.
#ifndef CANDIL_BASE_ROOM_H
#define CANDIL_BASE_ROOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define ROOM_LEAST_MIB 128u // with less, some of our programs end before they could say that it is too little
#define ROOM_IMAGES_BYTES (448ull << 20) // OpenImageIO with its libraries, whose constructors start threads

// MiB that this process, and each that it starts, may have; 0: as many as there are.
uint64_t room_limit_mib(void);

// Can so many bytes more be mapped? Without /proc, which knows how many are, it is said that they can.
bool room_left(uint64_t bytes);

// Append to a sentence about a want of memory what may mend it: the limit, if there is one. `capacity` counts the
// terminating zero; what does not fit is cut.
void room_advise(char *sentence, size_t capacity);

#endif
