// Reads an encoded image back through OpenImageIO, whole, for tests: what the codec wrote, seen by the library's reader.
#ifndef CANDIL_TESTS_READBACK_H
#define CANDIL_TESTS_READBACK_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define READBACK_CHANNELS 16

enum readback_type { READBACK_OTHER, READBACK_HALF, READBACK_FLOAT, READBACK_UINT, READBACK_UINT8 };

struct readback {
	int width, height, channels;
	char name[READBACK_CHANNELS][32];
	enum readback_type type[READBACK_CHANNELS];
	double *values; // width × height × channels, interleaved; numbers as stored (8 bits: 0…255)
	void *attributes; // the library's own
};

// Read the file at descriptor `fd` (`bytes` long; named like a file of `extension`, "exr"). 0, or -1 with a line on stderr.
int readback_open(int fd, uint64_t bytes, const char *extension, struct readback *image);
double readback_value(const struct readback *image, int x, int y, const char *channel);

// A string attribute of the file, or NULL.
const char *readback_attribute(const struct readback *image, const char *name);
void readback_close(struct readback *image);

#ifdef __cplusplus
}
#endif

#endif
