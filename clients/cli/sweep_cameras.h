// The cameras of a sweep, from a file or as an orbit; and the names of their images.
#ifndef CANDIL_CLI_SWEEP_CAMERAS_H
#define CANDIL_CLI_SWEEP_CAMERAS_H

#include "clients/cli/cli.h"

#define SWEEP_CAMERAS_MAX 1000000u

// Read cameras: a JSON array of them, or one after the other. A camera is an array of ten numbers (eye, target, up, vertical
// angle) or an object {"eye": [x,y,z], "target": [x,y,z], "up": [x,y,z], "vfov": degrees}, up being +Y if it is left out.
// *cameras is the caller's, to be freed. false: `error` says why.
bool sweep_cameras_read(const char *path, struct candil_camera **cameras, uint32_t *count, struct candil_error *error);

// "N[,DEGREES[,METRES]]". false: it is not that, or out of range (1 to SWEEP_CAMERAS_MAX, within ±89, above 0).
bool sweep_orbit_parse(const char *text, uint32_t *count, double *elevation, double *radius);

// "I/N", 1 <= I <= N.
bool sweep_shard_parse(const char *text, uint32_t *shard, uint32_t *shards);

// `pattern` with each {index} replaced by the number, zeros before it to the width of `count`. NULL: no memory. To be freed.
char *sweep_name(const char *pattern, uint32_t index, uint32_t count);

#endif
