// Whether a picture that is there is the one that a sweep would make, by what its file says.
#ifndef CANDIL_CLI_SWEEP_COMPARE_H
#define CANDIL_CLI_SWEEP_COMPARE_H

#include "clients/cli/metadata.h"
#include "clients/cli/target.h"

// Why the picture at `path` has to be made again, in a word or two for a list: "camera", "scene", "no metadata", "not
// whole". Static. NULL: it is what `request`, with this camera, of the target's scene would give.
const char *sweep_compare(const char *path, const struct target *target, const struct candil_render_request *request,
			  const struct candil_camera *camera);

#endif
