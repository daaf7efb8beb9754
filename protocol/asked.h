// What a render request asks for, in words: each thing that shows in the picture, a key and a text that are equal for equal
// requests. The worker writes them into the file; `candil sweep` compares them with those of its own request.
//
// Left out is what words cannot hold, and what compares by itself: the size, the scene and the picture of its surroundings,
// whose hashes are in the file. Any thread.
#ifndef CANDIL_PROTOCOL_ASKED_H
#define CANDIL_PROTOCOL_ASKED_H

#include "candil.pb.h"

#define ASKED_KEY "request/" // stands before the keys in a file, after "candil/"
#define ASKED_TEXT_BYTES 1088u // of a text at most, with its zero: 16 options of the longest kind

// Take a key, which is static, and its text, which is not.
typedef void asked_take(void *user, const char *key, const char *text);

// Hand each key with its text to `take`. The request is checked, and its defaults are filled in, as the front does it.
void asked_words(const candil_Render *render, asked_take *take, void *user);

#endif
