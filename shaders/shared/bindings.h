// Binding numbers of set 0 and specialization constants, as far as they are not one technique's own. Shared by C and GLSL.
#ifndef CANDIL_SHARED_BINDINGS_H
#define CANDIL_SHARED_BINDINGS_H

#include "shared/layout.h"

// The resident scene. Every pass that traces rays binds these.
#define BIND_NODES 0
#define BIND_LEAF_TRIANGLES 1
#define BIND_TRIANGLES 2
#define BIND_VERTICES 3
#define BIND_MATERIALS 4
#define BIND_TEXTURES 5
#define BIND_TEXELS 6
#define BIND_EMITTERS 7
#define BIND_LIGHTS 8
#define BIND_SRGB_TABLE 9 // 256 floats: sRGB byte to linear; then, if a texture is deep, 65536 more: 16 bits to linear
#define BIND_UV1 10
#define BIND_COLORS 11
#define BIND_TANGENTS 12
#ifndef BIND_GGX_TABLE
#define BIND_GGX_TABLE 13 // directional albedos of the microfacet lobe, described below
#endif
#define BIND_SCENE_COUNT 14
// OpenGL's texture units of the first two, which are texel buffers there.
#define UNIT_NODES 14
#define UNIT_LEAF_TRIANGLES 15
// And of the next two, in a program that draws: struct triangle is a texel, struct vertex two.
#define UNIT_TRIANGLES 1
#define UNIT_VERTICES 2
// The job.
#define BIND_JOB 14 // struct scene_params
#define BIND_COUNTERS 15 // struct pass_counters
#ifndef BIND_ACCUMULATOR
#define BIND_ACCUMULATOR 16 // sums: 12 floats a pixel: half A then half B, R G B each as (hi, lo)
#endif
#define BIND_AOV 16 // AOV passes: 8 words for each pixel: depth, normal, albedo, id
// For passes that trace: the words of BIND_NODES and BIND_LEAF_TRIANGLES again, as texel buffers, four words a texel.
#define BIND_NODE_TEXELS 18
#define BIND_LEAF_TEXELS 19
#define BIND_TRACE_COUNT 20
// Where there is a light tree: struct light_node as texels, and each emitter's trail, a uint.
#define BIND_LIGHT_NODES 24
#define BIND_LIGHT_TRAILS 25
// Where emission has textures: struct emitter_grid of each emitter, and struct emitter_cell.
#define BIND_EMITTER_GRIDS 26
#define BIND_EMITTER_CELLS 27
// No pass has more bindings than BIND_MOST, of which at most BIND_TEXELS_MOST are texel buffers.
#define BIND_MOST 28
#define BIND_TEXELS_MOST 3

// Specialization constants. 0 … 31 switch the effects, by their number (effects.glsl, generated from protocol/names.h).
// Then come those of tracing, and from SPEC_PASS on a pass's own.
#define SPEC_EFFECTS 32
#define SPEC_PACKET 32 // subgroups walk the BVH as packets
#define SPEC_WIDTH 33 // lanes of a subgroup
#define SPEC_PASS 34
#define BUNDLE_RAYS 4 // of a lane, that a packet walks at once: trace/bundle.glsl
// Constants by the scene, of every pass that shades it: scene_traits of server/worker/technique/common/scene_params.h.
#define SPEC_SCENE 64
#define SPEC_DEEP_TEXTURES 64 // some texture is deep
#define SPEC_RANGED_LIGHTS 65 // some point or spot light has a range
#define SPEC_VAST_SCENE 66 // FACT_VAST
#define SPEC_SCENE_END 67

// How paths find the light of emissive surfaces: by points sampled on them and by BSDF sampling, weighted; by points alone;
// by BSDF sampling alone.
#define LAMPS_BY_BOTH 0
#define LAMPS_BY_POINTS 1
#define LAMPS_BY_CHANCE 2

// The table at BIND_GGX_TABLE. First the microfacets: for each of GGX_ROUGHNESSES perceptual roughnesses r and each of
// GGX_COSINES cosines μ, two floats (common/ggx.glsl), with √r and √μ evenly spaced from 0 to 1. Then, for each roughness,
// two floats: their mean over the hemisphere. Then the rough dielectric (common/glass.glsl): for each of GLASS_RATIOS
// relative indices of refraction η but the last, (η − 1) / (η + 1) evenly spaced from −1/2 to 1/2, GLASS_ROUGHNESSES by
// GLASS_COSINES pairs of floats, √r and √μ spaced as above: the share of light that single scattering keeps, at this η and
// at the next. Last, as many pairs again: the share of sampled directions that are on the intended side.
#define GGX_COSINES 64
#define GGX_ROUGHNESSES 64
#define GGX_TABLE_PAIRS (GGX_ROUGHNESSES * (GGX_COSINES + 1)) // before the dielectric's part
#define GLASS_RATIOS 33
#define GLASS_ROUGHNESSES 24
#define GLASS_COSINES 24
#define GLASS_TABLE_PAIRS ((GLASS_RATIOS - 1) * GLASS_ROUGHNESSES * GLASS_COSINES)

#define ACCUMULATOR_FLOATS 12
#define AOV_WORDS 8
#define TILE_SIDE 8 // pixels; a tile is one workgroup
#define TILE_PIXELS 64

#endif
