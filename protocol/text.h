// The protocol's strings are UTF-8 without control characters. Here is what that means, for everybody who checks a string
// from outside: names that clients give, sentences that other processes send, what a scene's file says.
//
// UTF-8 is as the standard has it: overlong forms, surrogates and code points past U+10FFFF are refused. Control characters
// are U+0000 to U+001F and U+007F to U+009F. All strings end with a zero. The functions have no state and may be called from
// any thread; none fails.
#ifndef CANDIL_PROTOCOL_TEXT_H
#define CANDIL_PROTOCOL_TEXT_H

#include <stdbool.h>
#include <stddef.h>

// Valid UTF-8 without control characters. The empty string is clean.
bool text_is_clean(const char *text);

// A name, of a scene for instance: clean, 1 to LIMIT_NAME bytes, no '/'.
bool text_is_name(const char *text);

// A relative path of plain components: clean, not empty, no leading '/', no "", "." or ".." component.
bool text_is_plain_path(const char *path);

// End `text` within its `capacity` ≥ 1 bytes and replace by '?' every byte that makes it unclean. Its length stays.
void text_clean(char *text, size_t capacity);

// Whether two sentences differ at most in their numbers, which begin with a digit that no letter, digit or '_' precedes.
bool text_alike(const char *a, const char *b);

// Copy `text` into `out` as clean text that fits `capacity` ≥ 1 bytes with its zero, cut before a character that does not
// fit. A byte that is unclean becomes '?', a line's end and a tab a space. What is left of `out` is zero.
void text_copy(char *out, size_t capacity, const char *text);

#endif
