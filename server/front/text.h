// Text from outside: names that clients give, sentences that other processes send. The protocol's strings are UTF-8.
#ifndef CANDIL_FRONT_TEXT_H
#define CANDIL_FRONT_TEXT_H

#include <stdbool.h>
#include <stddef.h>

// Valid UTF-8 without control characters.
bool text_is_clean(const char *text);

// A scene's name: clean, not empty, no '/', not longer than LIMIT_NAME.
bool text_is_name(const char *text);

// End `text` within `capacity` bytes and replace by '?' every byte that makes it unclean.
void text_clean(char *text, size_t capacity);

// A relative path of plain components: clean, not empty, no leading '/', no "", "." or ".." component.
bool text_is_plain_path(const char *path);

#endif
