// The protocol's lists of names in the texts of the command line. A text has a mark where it needs a list, so a new
// technique or effect appears in every help text and refusal without a change here:
//
//   {techniques}  the techniques that render, with "or" before the last
//   {auto}        the technique that "auto" stands for
//   {noise}       the techniques whose error falls with the number of samples, with "or" before the last
//   {voxels}      the technique whose voxels `candil inspect` looks into
//   {patches}     the technique whose patches it looks into
//   {effects}     all effects, with "or" before the last
//   {lights}      the kinds of lights with their keys, as --light takes them, "or" between them
//   {shares}      a material's shares, with "or" before the last
//
// Any other word in braces is printed as it stands.
#ifndef CANDIL_CLI_WORDS_H
#define CANDIL_CLI_WORDS_H

#include <stdio.h>

// Print `text` with its marks filled in. An effect, a light or a share that does not fit into the line of a help text begins
// a new one, behind `indent` spaces; 0: no line is broken.
void words_print(FILE *out, const char *text, unsigned indent);

// What words_print prints without breaking lines, as a string. It is the caller's, to be freed; NULL: no memory.
char *words_text(const char *text);

#endif
