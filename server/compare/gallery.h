// The page of `candil compare --html`: pictures beside a reference, with a comparer. One thread.
#ifndef CANDIL_COMPARE_GALLERY_H
#define CANDIL_COMPARE_GALLERY_H

#include "server/base/error.h"

// Shown larger than this a side, pictures are averaged down by a whole factor; figures are of all pixels.
#define GALLERY_SIDE 1024u

// Write a page of `count` pictures, 2 or more, that are compared with the second of them. Failures are those of
// picture_read, metrics_fit, comparison_make and html_save.
enum status gallery_write(const char *path, char *const *files, int count, double mask_above, struct error *err);

#endif
