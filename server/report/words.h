// Numbers as people read them, and what a study says in sentences. Any thread.
#ifndef CANDIL_REPORT_WORDS_H
#define CANDIL_REPORT_WORDS_H

#include "server/report/judge.h"

#define WORDS_NUMBER 32u

// A time, "51 ms", "1.2 s", "3 min 20 s"; an error, "0.031", "2.1·10⁻⁵"; a share, "12 %". "unknown" for NaN. Return `out`.
const char *words_seconds(double seconds, char out[WORDS_NUMBER]);
const char *words_error(double error, char out[WORDS_NUMBER]);
const char *words_share(double share, char out[WORDS_NUMBER]);

// A point's settings, "samples 16, vct.resolution 64", to be freed; NULL: no memory.
char *words_settings(const json_t *settings);

// The sentences that a report begins with, an array of strings: which technique is the most accurate up to when, where each
// floor is, who overtakes whom, what is missing. NULL: no memory.
json_t *words_of(const struct figures *figures, const struct judgement *judgement);

#endif
