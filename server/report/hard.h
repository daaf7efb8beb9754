// The rows of the page of hard cases (tests/hard/TABLE.md) that a study's techniques have. One thread.
#ifndef CANDIL_REPORT_HARD_H
#define CANDIL_REPORT_HARD_H

#include "server/compare/html.h"
#include "server/report/judge.h"

// Read the page, to be freed. STATUS_IO, STATUS_LIMIT (LIMIT_REPORT_TABLE_BYTES), STATUS_MEMORY.
enum status hard_read(const char *path, char **text, struct error *err);

// Write its tables, each under its heading, with the rows of the techniques of the judgement. Returns how many rows.
size_t hard_write(struct html *html, const char *text, const struct judgement *judgement);

#endif
