// Where the passes of the deferred techniques find what they share, for C and GLSL: uniform locations, texture and image
// units. A technique's own begin at the …_FREE ones; its storage blocks are whatever of bindings.h it does not use, and
// those from BIND_ACCUMULATOR on.
#ifndef CANDIL_SHARED_DEFERRED_H
#define CANDIL_SHARED_DEFERRED_H

#define DEFERRED_AREA 0 // uvec4: the band's first row, its rows, the dispatch's first tile (of the image), its tiles
#define DEFERRED_SAMPLE 1 // uvec4: half (0 or 1), index within the half, number in the job, the image's width
#define DEFERRED_JITTER 2 // vec2: where in the pixel, 0…1
#define DEFERRED_TRIANGLE 3 // uint: first of the draw
#define DEFERRED_LOCATION_FREE 8

#define DEFERRED_VISIBILITY_UNIT 0 // texture: triangle id + 1, row 0 being the band's first
#define DEFERRED_TEXTURE_FREE 1

#define DEFERRED_RADIANCE_UNIT 0 // image: this sample's radiance, and the rays that it took
#define DEFERRED_IMAGE_FREE 1

// Images of the direct lighting's own, for passes that include direct/lamp_image.glsl.
#define DIRECT_SCALE_UNIT 1
#define DIRECT_ARRIVED_UNIT 2
#define DIRECT_EXPECTED_UNIT 3
#define DIRECT_FACETS_UNIT 4

#define VISIBLE_NEAR 1e-15 // metres: nothing nearer to the eye is drawn; at 10²⁰ metres its quotient is still a normal float

#endif
