// The options that change the scene for one request: --light, --replace-lights, --material, --node, --animation and --at.
// render, sweep and inspect share them.
#ifndef CANDIL_CLI_EDIT_OPTIONS_H
#define CANDIL_CLI_EDIT_OPTIONS_H

#include "clients/cli/cli.h"
#include "protocol/limits.h"

enum {
	OPTION_LIGHT = 1300,
	OPTION_REPLACE_LIGHTS,
	OPTION_MATERIAL,
	OPTION_NODE,
	OPTION_ANIMATION,
	OPTION_AT,
};

#define EDIT_OPTIONS \
	{"light", required_argument, NULL, OPTION_LIGHT}, {"replace-lights", no_argument, NULL, OPTION_REPLACE_LIGHTS}, \
	    {"material", required_argument, NULL, OPTION_MATERIAL}, {"node", required_argument, NULL, OPTION_NODE}, \
	{ \
		"animation", required_argument, NULL, OPTION_ANIMATION \
	}

struct edit_options {
	struct candil_edits edits; // points into the arrays below
	struct candil_light lights[LIMIT_EDIT_LIGHTS];
	struct candil_material_edit materials[LIMIT_EDIT_MATERIALS];
	struct candil_node_edit nodes[LIMIT_EDIT_NODES];
	bool given; // at least one
	bool at; // --at
	bool full; // the last one failed because a request can have no more of its kind
};

void edit_options_init(struct edit_options *options);

// Whether an option is one of these.
bool edit_is_option(int option);

// Take one option. Cuts `value` up: names point into it. false: the value is wrong, or `full`.
bool edit_option(int option, char *value, struct edit_options *options);

// What an option takes, for a sentence; with marks of words.h.
const char *edit_option_form(int option);

// For the help of render and sweep.
#define EDIT_OPTIONS_HELP \
	"  --light KIND:KEY=VALUE,...\n" \
	"                        one more light for this picture, up to 32 times:\n" \
	"                        {lights}.\n" \
	"                        A cone's degrees are from its axis; direction= may stand in place of to=;\n" \
	"                        angle=DEGREES makes a directional light a disc so wide (path tracing; the sun: 0.53);\n" \
	"                        range=METRES ends the light of a point light or a spot there, as glTF's.\n" \
	"                        I is one number or r,g,b, in W/sr, of a directional light W/m²\n" \
	"  --replace-lights      the scene's own point, spot and directional lights are out\n" \
	"  --material NAME:KEY=VALUE,...\n" \
	"                        another look for a material: color, emission (W/(m² sr)), specular (each r,g,b or one\n" \
	"                        number), {shares};\n" \
	"                        textures go on multiplying\n" \
	"  --node NAME:KEY=VALUE,...\n" \
	"                        another place for a node and all beneath it, relative to its parent: translate=x,y,z,\n" \
	"                        rotate=x,y,z,DEGREES (about that axis), scale=S or x,y,z; what is not said stays\n" \
	"                        A NAME is one that candil describe lists, or '#' and its number there, from 0; one that\n" \
	"                        has an equals sign can be had by its number alone\n"

#endif
