// Text that a daemon sent.
#ifndef CANDIL_LIBCANDIL_TEXT_H
#define CANDIL_LIBCANDIL_TEXT_H

#include <stddef.h>

// Copy `in` to `out`, at most `capacity` - 1 bytes. The copy ends with a zero, is valid UTF-8 and has no control characters,
// because a terminal may show it: a line end or a tab becomes a space, any other byte that is refused a '?'.
void text_copy(char *out, size_t capacity, const char *in);

#endif
