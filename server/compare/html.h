// A page as it grows in memory. Whatever comes from outside passes html_put's %s or html_text, which escape it, or
// html_json, which no script element ends early. One thread. A failure (memory) is kept and told by html_take alone.
#ifndef CANDIL_COMPARE_HTML_H
#define CANDIL_COMPARE_HTML_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "server/base/error.h"

struct html {
	FILE *out;
	char *text;
	size_t bytes;
	bool failed;
};

// STATUS_MEMORY. html_finish is due either way.
enum status html_init(struct html *html, struct error *err);
void html_finish(struct html *html); // a zeroed one is fine

void html_raw(struct html *html, const char *markup); // ours, as it stands
void html_text(struct html *html, const char *text); // for elements and for attributes in double quotes

// Markup with values: as printf, of conversions %s (escaped), %d, %zu, %u, %g and %f with flags, width and precision; %%.
void html_put(struct html *html, const char *format, ...) __attribute__((format(printf, 2, 3)));

// A value as the content of <script type="application/json">: "<" and "&" are written as their escapes.
void html_json(struct html *html, const json_t *value);

// The content of a script element out of a file that is not ours: "</" becomes "<\/".
void html_script(struct html *html, const char *text, size_t bytes);

// "data:TYPE;base64,…"
void html_data(struct html *html, const char *type, const uint8_t *bytes, size_t size);

// A slot of a template: {{name}}. `fill` writes what stands there.
struct html_slot {
	const char *name;
	void (*fill)(struct html *html, const void *context);
};

// Write a template of ours, its slots filled; one that `slots` (ended by a NULL name) has not is a failure.
void html_template(struct html *html, const char *text, const struct html_slot *slots, const void *context);

// How many bytes there are so far.
size_t html_size(struct html *html);

// Write the page to a file, which appears whole or not at all. STATUS_MEMORY, STATUS_IO.
enum status html_save(struct html *html, const char *path, struct error *err);

#endif
