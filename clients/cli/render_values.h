// What the options of `candil render` say as text, put into a request. Each function is false where the text is none of what
// it takes; what it has put in by then is nobody's. Texts that become names stay the caller's: they point into argv.
#ifndef CANDIL_CLI_RENDER_VALUES_H
#define CANDIL_CLI_RENDER_VALUES_H

#include <stdbool.h>

#include "clients/libcandil/candil.h"

bool value_size(const char *text, struct candil_render_request *request); // "640x480", above 0
bool value_technique(const char *text, struct candil_render_request *request);
bool value_view(const char *text, struct candil_render_request *request);
bool value_filter(const char *text, struct candil_render_request *request); // "box", "gauss", "bh"
bool value_lens(const char *text, struct candil_lens *lens); // "RADIUS,FOCUS", above 0
bool value_orthographic(const char *text, struct candil_lens *lens); // the picture's height, above 0

// Ten numbers are a camera, anything else without a comma is the name of one.
bool value_camera(const char *text, struct candil_render_request *request);

// Three numbers are a colour, anything that does not look like numbers is a picture: a name or a file.
bool value_background(const char *text, struct candil_render_request *request);

// Lists with commas, which are cut up. *wrong is the word that is none. Effects: "auto", "all" and "none" begin anew,
// "+NAME" or "NAME" and "-NAME" add to what is said.
bool value_effects(char *list, struct candil_render_request *request, const char **wrong);
bool value_aovs(char *list, struct candil_render_request *request, const char **wrong);

#endif
