// From the values of options, which are text, to the fields of a request. Each function returns false if the text is wrong;
// the fields that it sets are then undefined. A name in the request points to the text.
#ifndef CANDIL_CLI_RENDER_VALUES_H
#define CANDIL_CLI_RENDER_VALUES_H

#include <stdbool.h>

#include "clients/libcandil/candil.h"

bool value_size(const char *text, struct candil_render_request *request); // "640x480", above 0
bool value_technique(const char *text, struct candil_render_request *request);
bool value_view(const char *text, struct candil_render_request *request);
bool value_filter(const char *text, struct candil_render_request *request); // "box", "gauss", "bh"
bool value_lens(const char *text, struct candil_lens *lens); // "RADIUS,FOCUS", metres, above 0
bool value_orthographic(const char *text, struct candil_lens *lens); // the height of the picture, metres, above 0

// Ten numbers are a camera. Anything else without a comma is the name of one.
bool value_camera(const char *text, struct candil_render_request *request);

// Three numbers are a colour. Anything that does not look like numbers is a picture: a name or a file.
bool value_background(const char *text, struct candil_render_request *request);

// Lists with commas, which are cut up. *wrong is the word that is wrong. Of effects, "auto", "all" and "none" replace what
// came before; "+NAME" or "NAME", and "-NAME", change one effect.
bool value_effects(char *list, struct candil_render_request *request, const char **wrong);
bool value_aovs(char *list, struct candil_render_request *request, const char **wrong);

#endif
