// The cameras of a sweep, from a file or on an orbit, and the names of their images.
#ifndef CANDIL_CLI_SWEEP_CAMERAS_H
#define CANDIL_CLI_SWEEP_CAMERAS_H

#include "clients/cli/cli.h"

#define SWEEP_CAMERAS_MAX 1000000u

// Read cameras from a file: a JSON array of them, or one after the other. A camera is an array of ten numbers (eye, target,
// up, vertical angle) or an object {"eye": [x,y,z], "target": [x,y,z], "up": [x,y,z], "vfov": degrees}, up being +Y if it is
// left out. *cameras is the caller's, to be freed. false: `error` says why, and names the `option` that the file was given
// by.
bool sweep_cameras_read(const char *path, const char *option, struct candil_camera **cameras, uint32_t *count,
			struct candil_error *error);

// Parse "N[,DEGREES[,METRES]]": 1 to SWEEP_CAMERAS_MAX, -89 to 89, above 0. false: the text is something else.
bool sweep_orbit_parse(const char *text, uint32_t *count, double *elevation, double *radius);

// Parse "I/N", 1 <= I <= N. false: the text is something else.
bool sweep_shard_parse(const char *text, uint32_t *shard, uint32_t *shards);

// Whether a name has a {word} that is not {index}: then the sentence that refuses it is in `out`.
bool sweep_name_unknown(const char *pattern, char *out, size_t capacity);

// `pattern` with each {index} replaced by the number, which gets zeros before it up to the width of `count`. The result is
// the caller's, to be freed; NULL: no memory.
char *sweep_name(const char *pattern, uint32_t index, uint32_t count);

#endif
