// Techniques, effects, kinds of errors and of lights: their numbers, their names, and what every program has to know about
// them; and what of a material is a share. Everything else is made from these lists: the library's enumerations
// (candil_names.h), the shaders' bits (effects.glsl), the words and the help of the command line, and the reasons in a
// reply. candil.proto repeats the numbers for other languages, and names.c does not compile if it repeats them wrongly. A
// number never changes its meaning; new ones go to the end.
//
// Any thread may call the functions. None of them fails or allocates; strings that they return are static.
//
// Example:
//	char list[64];
//	technique_list(TECHNIQUE_RENDERS, "or", list, sizeof list);
//	assert(strcmp(list, "pt, vct, radiosity or direct") == 0);
//	assert(technique_number("pt", 2) == 1 && strcmp(technique_name(1), "pt") == 0);
//	assert(technique_number("nothing", 7) == -1 && strcmp(technique_name(TECHNIQUE_COUNT), "unknown") == 0);
//	names_list((const char *const[]){"a", "b", "c"}, 3, "and", list, sizeof list);
//	assert(strcmp(list, "a, b and c") == 0);
//	assert(technique_takes(2, "direct.samples") && !technique_takes(4, "vct.cones"));
//	assert(technique_traits(0) == technique_traits(TECHNIQUE_OF_AUTO));
//	light_kind_list(LIGHT_HAS_PLACE, "or", list, sizeof list);
//	assert(strcmp(list, "a point light or a spot") == 0);
//	assert(strcmp(error_kind_name(error_kind_of_both(1, 2)), "predicted") == 0);
//	for (unsigned i = 0; i < EFFECT_COUNT; i++)
//		printf("%s runs where %s\n", effect_name(i), effect_words(i)->simulated);
#ifndef CANDIL_PROTOCOL_NAMES_H
#define CANDIL_PROTOCOL_NAMES_H

#include <stdbool.h>
#include <stddef.h>

// Traits of a technique, bits: what of it a request can ask for.
#define TECHNIQUE_RENDERS 1u // a worker has it; without the bit the name is only reserved
#define TECHNIQUE_NOISE 2u // its error falls with the number of samples, and it estimates that error
#define TECHNIQUE_LENS 4u // it has lenses with a radius, every pixel filter, and panoramas
#define TECHNIQUE_VOXELS 8u // it has voxels to show: `candil inspect`
#define TECHNIQUE_PATCHES 16u // it has patches and form factors to show, likewise

// X(NAME, number, "name", traits, options), the last bits 1u << number of the techniques whose options it takes: those that
// begin with their names and a dot.
#define CANDIL_TECHNIQUE_LIST(X) \
	X(AUTO, 0, "auto", 0u, 0u) \
	X(PT, 1, "pt", TECHNIQUE_RENDERS | TECHNIQUE_NOISE | TECHNIQUE_LENS, 1u << 1) \
	X(VCT, 2, "vct", TECHNIQUE_RENDERS | TECHNIQUE_VOXELS, 1u << 2 | 1u << 4) \
	X(RADIOSITY, 3, "radiosity", TECHNIQUE_RENDERS | TECHNIQUE_PATCHES, 1u << 3 | 1u << 4) \
	X(DIRECT, 4, "direct", TECHNIQUE_RENDERS, 1u << 4)

// The number of the technique that "auto" stands for where nothing is asked for that it could be chosen by, and in a sweep:
// server/front/quotes chooses otherwise.
#define TECHNIQUE_OF_AUTO 1u

// An option that help texts take for an example.
#define TECHNIQUE_OPTION_EXAMPLE "pt.depth=8"

// The word by which users name the file that a request imports. On the wire it is no option: the file is loaded first.
#define TECHNIQUE_OPTION_IMPORT "radiosity.import"

// X(NAME, number, "name", why it is simulated, why it is left out, why it is left out although something has it by name,
// what is drawn instead where it is switched off)
#define CANDIL_EFFECT_LIST(X) \
	X(TEXTURES, 0, "textures", "materials have textures", "no material has a texture", \
	  "textures change nothing: white, on black, or of a part without weight", "materials show their factors alone") \
	X(EMITTERS, 1, "emitters", "surfaces emit light", "no surface emits light", \
	  "what emits light by name has a black texture or no area", "emissive surfaces are black") \
	X(LIGHTS, 2, "lights", "the scene has point, spot or directional lights", \
	  "the scene has no point, spot or directional light that shines", "", \
	  "point, spot and directional lights are dark") \
	X(ENVIRONMENT, 3, "environment", "the background is not black", "the background is black", "", \
	  "whatever the background is, it is drawn black") \
	X(BOUNCES, 4, "bounces", "light scatters more than once", \
	  "light cannot scatter twice: pt.depth or vct.bounces says so, nothing reflects or nothing shines", "", \
	  "direct light alone") \
	X(GLOSSY, 5, "glossy", "some surface is glossy or metallic", "no surface is glossy or metallic", \
	  "what is glossy or metallic by name is clear, unlit, nowhere there or zero by its texture", \
	  "surfaces are diffuse with their base colour") \
	X(NORMAL_MAPS, 6, "normal-maps", "materials have normal maps", "no material has a normal map", \
	  "normal maps have a scale of zero or no coordinates, or lie where nothing reflects", \
	  "surfaces have the mesh's own normals") \
	X(ALPHA_MASK, 7, "alpha-mask", "materials are cut out by alpha", "no material is cut out by alpha", \
	  "the alpha of masks is nowhere below their cutoff", "surfaces have no holes") \
	X(VERTEX_COLORS, 8, "vertex-colors", "vertices have colours", "no vertex has a colour", \
	  "vertex colours change nothing: on black, or an alpha that nothing reads", "vertices are white") \
	X(UNLIT, 9, "unlit", "materials are unlit", "no material is unlit", "what is unlit is nowhere there, by its alpha", \
	  "unlit surfaces are lit like any other") \
	X(GLASS, 10, "glass", "surfaces let light through", "no surface lets light through", \
	  "what is clear by name is all metal, unlit, nowhere there, or its texture makes it opaque", \
	  "clear surfaces are opaque with their base colour") \
	X(ALPHA_BLEND, 11, "alpha-blend", "materials are partly there", "no material is partly there", \
	  "the alpha of blended surfaces is 1 everywhere", "blended surfaces are whole") \
	X(CLEARCOAT, 12, "clearcoat", "materials have a clear coat", "no material has a clear coat", \
	  "coats are zero by their textures, or lie on what is clear, unlit or nowhere there", "coats are left out") \
	X(ROUGH_DIFFUSE, 13, "rough-diffuse", "diffuse surfaces are rough", "no diffuse surface is rough", \
	  "what is rough by name has no diffuse part: it is metal, clear, black or unlit", \
	  "diffuse surfaces are smooth: Lambert's") \
	X(CAUSTICS, 14, "caustics", "polished surfaces throw lamps' light about", \
	  "light cannot come from a lamp by way of a polished surface and then scatter", "", \
	  "chance alone finds caustics, and none of a point, spot or directional light by way of a mirror")

// How the numbers on a picture's error are known. X(NAME, number, "name")
#define CANDIL_ERROR_KIND_LIST(X) \
	X(UNKNOWN, 0, "unknown") \
	X(MEASURED, 1, "measured") \
	X(PREDICTED, 2, "predicted")

// What a study of a scene turns of the techniques, one thing at a time, the others at their defaults: the options that buy
// accuracy with time. X("option", "values", "values of a quick study"), values between spaces. The option's name begins with
// that of its technique. The number of samples is not among them: all techniques have it.
#define CANDIL_KNOB_LIST(X) \
	X("vct.resolution", "32 64 256", "64") \
	X("vct.bounces", "0 1 4", "") \
	X("vct.cones", "6 16 32", "") \
	X("vct.gather", "rays", "") \
	X("vct.detail", "full", "") \
	X("vct.emitters", "cones", "") \
	X("vct.shadows", "map march cones volume", "") \
	X("vct.step", "0.25 1", "") \
	X("vct.start", "0.5 2", "") \
	X("radiosity.patches", "512 2048 16384", "1024") \
	X("radiosity.rays", "256 4096", "") \
	X("radiosity.display", "constant gather", "gather") \
	X("direct.samples", "8 32", "8") \
	X("direct.shadows", "map none", "")

// What a light has beside its intensity: bits.
#define LIGHT_HAS_PLACE 1u
#define LIGHT_HAS_DIRECTION 2u
#define LIGHT_HAS_CONE 4u // about its direction, with an inner and an outer angle
#define LIGHT_HAS_DISC 8u // that it shines from, with an angle across

// X(NAME, number, "name", traits, what a sentence calls it, what the command line's --light takes)
#define CANDIL_LIGHT_KIND_LIST(X) \
	X(POINT, 0, "point", LIGHT_HAS_PLACE, "a point light", "point:at=x,y,z,intensity=I") \
	X(SPOT, 1, "spot", LIGHT_HAS_PLACE | LIGHT_HAS_DIRECTION | LIGHT_HAS_CONE, "a spot", \
	  "spot:at=x,y,z,to=x,y,z,cone=INNER,OUTER,intensity=I") \
	X(DIRECTIONAL, 2, "directional", LIGHT_HAS_DIRECTION | LIGHT_HAS_DISC, "a directional light", \
	  "directional:direction=x,y,z,intensity=I")

// Radiance of the neutral sky that default light is, W/(m² sr), of each channel. The sky is seen as a light grey, and
// nothing beneath it is brighter, so that no picture is clipped.
#define DEFAULT_LIGHT_RADIANCE 0.8

// What of a material is a share, from 0 to 1, that a request may edit. X(field, "name"): the field of MaterialEdit, of
// candil_material_edit and of struct material; the key of the command line's --material.
#define CANDIL_MATERIAL_SHARES(X) \
	X(specular_weight, "specular-weight") \
	X(metallic, "metallic") \
	X(roughness, "roughness") \
	X(diffuse_roughness, "diffuse-roughness") \
	X(coat, "coat") \
	X(coat_roughness, "coat-roughness")

// How many there are; numbers are below it.
#define COUNTED(NAME, ...) COUNTED_TECHNIQUE_##NAME,
enum { CANDIL_TECHNIQUE_LIST(COUNTED) TECHNIQUE_COUNT };
#undef COUNTED
#define COUNTED(NAME, ...) COUNTED_EFFECT_##NAME,
enum { CANDIL_EFFECT_LIST(COUNTED) EFFECT_COUNT };
#undef COUNTED
#define COUNTED(NAME, ...) COUNTED_ERROR_KIND_##NAME,
enum { CANDIL_ERROR_KIND_LIST(COUNTED) ERROR_KIND_COUNT };
#undef COUNTED
#define COUNTED(NAME, ...) COUNTED_LIGHT_##NAME,
enum { CANDIL_LIGHT_KIND_LIST(COUNTED) LIGHT_KIND_COUNT };
#undef COUNTED

// The name of a number: "pt", "textures", "measured"; "unknown" for a number that nothing has.
const char *technique_name(unsigned technique);
const char *effect_name(unsigned effect);
const char *error_kind_name(unsigned kind);

// How the mean of two errors is known: as its worse part, where predicted is worse than measured and unknown worst.
unsigned error_kind_of_both(unsigned a, unsigned b);

// The number of the technique whose name is the `length` bytes at `name`, which need not be followed by a zero; -1: there is
// none.
int technique_number(const char *name, size_t length);

// Whether a file of this format (candil_Format) is a picture. The others are what a technique with TECHNIQUE_PATCHES
// computes with.
bool format_is_picture(unsigned format);

// The word of a format: "exr-half", "png", "mtx"; "unknown" for a number that nothing has.
const char *format_name(unsigned format);

// The traits of a technique, TECHNIQUE_… bits, for "auto" those of the technique that it stands for; and of a kind of light,
// LIGHT_HAS_… bits. 0 for a number that nothing has.
unsigned technique_traits(unsigned technique);
unsigned light_kind_traits(unsigned kind);

// Whether a technique takes the options that begin as this one does.
bool technique_takes(unsigned technique, const char *option);

// `count` names as a list in a sentence: "pt, vct and direct" if `last` is "and". Cut where `capacity` bytes are too few.
void names_list(const char *const *names, size_t count, const char *last, char *out, size_t capacity);

// The same of the techniques or kinds that have all of `traits`, in the order of their numbers. Of kinds, what a sentence
// calls them: "a point light or a spot".
void technique_list(unsigned traits, const char *last, char *out, size_t capacity);
void light_kind_list(unsigned traits, const char *last, char *out, size_t capacity);

// The least number of a technique that has all of `traits`; -1: there is none.
int technique_with(unsigned traits);

// What to say of one effect, as ends of sentences without a full stop.
struct effect_words {
	const char *name;
	const char *simulated; // why it runs
	const char *absent; // why it does not
	const char *inert; // why it does not although something has it by name; "" where that cannot be
	const char *substitute; // what is drawn instead where it is switched off
};

// The words of an effect, never NULL; all of them are "" for a number that nothing has.
const struct effect_words *effect_words(unsigned effect);

#endif
