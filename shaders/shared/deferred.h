// Uniform locations, texture units and image units that the passes of the deferred techniques share. Used by C and GLSL. A
// technique's own begin at the …_FREE ones. Its storage blocks are those of bindings.h that it does not use otherwise, and
// those from BIND_ACCUMULATOR on.
#ifndef CANDIL_SHARED_DEFERRED_H
#define CANDIL_SHARED_DEFERRED_H

#define DEFERRED_AREA 0 // uvec4: the band's first row, its rows, the dispatch's first tile (of the image), its tiles
#define DEFERRED_SAMPLE 1 // uvec4: half (0 or 1), index within the half, number in the job; the image's width
#define DEFERRED_JITTER 2 // vec2: position within the pixel, 0…1
#define DEFERRED_TRIANGLE 3 // uint: first triangle of the draw
#define DEFERRED_LOCATION_FREE 8

#define DEFERRED_VISIBILITY_UNIT 0 // texture: triangle id + 1; row 0 is the band's first
#define DEFERRED_TEXTURE_FREE 1

#define DEFERRED_RADIANCE_UNIT 0 // image: radiance of this sample, and the number of rays traced for it
#define DEFERRED_IMAGE_FREE 1

// Images of direct lighting, for passes that include direct/lamp_image.glsl.
#define DIRECT_SCALE_UNIT 1
#define DIRECT_ARRIVED_UNIT 2
#define DIRECT_EXPECTED_UNIT 3
#define DIRECT_FACETS_UNIT 4

#define VISIBLE_NEAR 1e-15 // metres: nothing nearer to the eye is drawn; at 10²⁰ metres the depth is still a normal float

#endif
