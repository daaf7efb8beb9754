// What the stand-ins for candil-worker and candil-loader share: they speak ipc.h, need no device and do as they are told, so
// that the front's behaviour can be tested to the message. The front's fence holds for them, too: they write nowhere but
// beneath the daemon's folder, which wire.py names as that of compiled shaders.
#ifndef CANDIL_TESTS_FAKE_H
#define CANDIL_TESTS_FAKE_H

#include <stdbool.h>

// A number of the environment, which has the variables FAKE_… of the daemon's, or `otherwise`.
unsigned long fake_number(const char *name, unsigned long otherwise);

// Is any descriptor open but those up to `last`?
bool fake_inherited(int last);

// A sealed memfd of `bytes`: byte i is (i * 31 + seed) modulo 256. Ends the program on failure.
int fake_memfd(unsigned long bytes, unsigned seed, bool seal);

// A sealed one of zeros that takes no memory until it is read.
int fake_sparse_memfd(unsigned long bytes);

#endif
