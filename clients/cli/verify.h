// Whether an image file is whole, without an image library: the marks that an interrupted write or a cut copy leaves out.
//  - PNG: signature, IHDR of this size, one chunk after the other within the file, IDAT among them, IEND at its very end.
//  - EXR, scan lines, one part: header with a data window of this size, an offset table without a gap, every block that it
//    points at within the file and bearing the line that belongs there, the last one ending where the file ends.
// What is inside of pixels is not looked at: bits that a disk has turned are not found.
#ifndef CANDIL_CLI_VERIFY_H
#define CANDIL_CLI_VERIFY_H

#include <stdbool.h>
#include <stdint.h>

// A PNG if `png`, else an EXR. false also for a file that is not there or cannot be read.
bool verify_image(const char *path, bool png, uint32_t width, uint32_t height);

#endif
