// make_names library|shaders: what names.h lists, in the form that another file needs, on standard output. Run when we are
// built.
//   library: candil_names.h, the enumerations of libcandil
//   shaders: effects.glsl, the constants of the effects
#include <stdio.h>
#include <string.h>

#include "protocol/names.h"
#include "protocol/status.h"

static const char library_head[] =
    "// Made of protocol/status.h and protocol/names.h, part of candil_types.h: numbers that are also those of the wire.\n"
    "#ifndef CANDIL_NAMES_H\n"
    "#define CANDIL_NAMES_H\n\n"
    "// What went wrong; PROTOCOL.md says what each means. A server newer than this header may send other numbers: treat\n"
    "// those as a plain failure.\n"
    "typedef enum candil_status {\n";

static void print_library(void)
{
	fputs(library_head, stdout);
#define STATUS(NAME, number, wire) printf("\tCANDIL_STATUS_%s = %d, // \"%s\"\n", #NAME, number, wire);
	CANDIL_STATUS_LIST(STATUS)
	puts("} candil_status;\n\nenum candil_technique {");
#define TECHNIQUE(NAME, number, name, ...) \
	printf("\tCANDIL_TECHNIQUE_%s = %d, // \"%s\"%s\n", #NAME, number, name, \
	       technique_traits(number) ? "" : ": not there yet, it is refused");
	CANDIL_TECHNIQUE_LIST(TECHNIQUE)
	puts("};\n\n// What a light of an edit is.\nenum candil_light_kind {");
#define LIGHT_KIND(NAME, number, name, traits, called, form) \
	printf("\tCANDIL_LIGHT_%s = %d, // %s\n", #NAME, number, called);
	CANDIL_LIGHT_KIND_LIST(LIGHT_KIND)
	puts("};\n\n// An effect's bit in effects_on and effects_off is 1u << effect.\nenum candil_effect {");
#define EFFECT(NAME, number, name, simulated, absent, inert, substitute) \
	printf("\tCANDIL_EFFECT_%s = %d, // \"%s\"; switched off: %s\n", #NAME, number, name, substitute);
	CANDIL_EFFECT_LIST(EFFECT)
	printf("};\n#define CANDIL_EFFECT_COUNT %du\n\n#endif\n", EFFECT_COUNT);
}

static void print_shaders(void)
{
	puts("// Made of protocol/names.h: what runs, of the plan. An effect is a specialization constant of a Vulkan "
	     "pipeline, and a\n"
	     "// macro of an OpenGL program; a program that comes without them has everything on.\n"
	     "#ifdef VULKAN");
#define CONSTANT(NAME, number, ...) printf("layout(constant_id = %d) const bool EFFECT_%s = true;\n", number, #NAME);
	CANDIL_EFFECT_LIST(CONSTANT)
	puts("#else");
#define MACRO(NAME, ...) printf("#ifndef EFFECT_%s\n#define EFFECT_%s true\n#endif\n", #NAME, #NAME);
	CANDIL_EFFECT_LIST(MACRO)
	puts("#endif");
}

int main(int argc, char **argv)
{
	if (argc != 2)
		return 2;
	if (!strcmp(argv[1], "library"))
		print_library();
	else if (!strcmp(argv[1], "shaders"))
		print_shaders();
	else
		return 2;
	return fflush(stdout) == 0 ? 0 : 1;
}
