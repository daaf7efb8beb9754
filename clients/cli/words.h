// The protocol's lists in the texts of the command line. A text holds a mark where it needs a list, so that a new technique
// or effect is in every help text and refusal by itself:
//
//   {techniques}  the techniques that render, with "or" before the last
//   {auto}        the technique that "auto" stands for
//   {noise}       the techniques whose error falls with the number of samples, with "or" before the last
//   {voxels}      the technique that `candil inspect` looks into
//   {effects}     all effects, with "or" before the last
//
// Any other word in braces is printed as it stands.
#ifndef CANDIL_CLI_WORDS_H
#define CANDIL_CLI_WORDS_H

#include <stdio.h>

// Print `text` with its marks filled in. An effect that would end beyond the last column of a help text begins a new line,
// behind `indent` spaces; 0: nothing is broken.
void words_print(FILE *out, const char *text, unsigned indent);

// What words_print prints without line breaks, as a string, to be freed. NULL: no memory.
char *words_text(const char *text);

#endif
