// Whether an image file is whole, found out without an image library. An interrupted write or a cut copy lacks one of these:
//
//  - PNG: the signature, an IHDR of this size, chunks that follow each other within the file, an IDAT among them, an IEND at
//    the end of the file.
//  - EXR of scan lines in one part: a header with a data window of this size, an offset table without a gap, blocks within
//    the file that hold the line which the table says, the last of them ending where the file ends.
//
// Pixels are not decoded, so a bit that a disk has flipped is not found.
#ifndef CANDIL_CLI_VERIFY_H
#define CANDIL_CLI_VERIFY_H

#include <stdbool.h>
#include <stdint.h>

#include "clients/cli/metadata.h"

// Check a PNG if `png`, else an EXR, and append its candil/… texts to *metadata. false: it is not whole, does not exist or
// cannot be read.
bool verify_image(const char *path, bool png, uint32_t width, uint32_t height, struct metadata *metadata);

#endif
