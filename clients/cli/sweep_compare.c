#include "clients/cli/sweep_compare.h"

#include <stdio.h>
#include <string.h>

#include "clients/cli/verify.h"
#include "clients/libcandil/message.h"

struct comparison {
	const struct metadata *metadata;
	const char *why; // the first key that differs; NULL: none so far
};

static void compare_words(void *user, const char *key, const char *text)
{
	struct comparison *c = user;
	char whole[METADATA_KEY_BYTES];
	snprintf(whole, sizeof(whole), ASKED_KEY "%s", key);
	const char *there = metadata_find(c->metadata, whole);
	if (!c->why && (!there || strcmp(there, text) != 0))
		c->why = key;
}

// "" is the hash of nothing.
static bool same_hash(const struct metadata *metadata, const char *key, const char *hash)
{
	const char *there = metadata_find(metadata, key);
	return strcmp(there ? there : "", hash) == 0;
}

const char *sweep_compare(const char *path, const struct target *target, const struct candil_render_request *request,
			  const struct candil_camera *camera)
{
	// Static because they are large.
	static struct metadata metadata;
	static candil_Sweep sweep;
	struct candil_error error;
	metadata.count = 0;
	if (!verify_image(path, request->format == CANDIL_FORMAT_PNG, request->width, request->height, &metadata))
		return "size, or not whole";
	if (metadata.count == 0)
		return "no metadata";
	if (!same_hash(&metadata, "scene_hash", target->info.hash))
		return "scene";
	if (!same_hash(&metadata, "environment_hash", target->picture.hash))
		return "background's picture";
	if (!same_hash(&metadata, "import_hash", target->imported.hash))
		return "imported file";
	memset(&sweep, 0, sizeof(sweep));
	// The daemon refuses the same, and says why.
	if (message_write_sweep(request, camera, 1, &sweep, &error) != CANDIL_STATUS_OK)
		return "request";
	sweep.render.has_camera = true;
	sweep.render.camera = sweep.cameras[0];
	if (sweep.times_count > 0)
		sweep.render.edits.time_s = sweep.times[0];
	struct comparison comparison = {.metadata = &metadata};
	asked_words(&sweep.render, compare_words, &comparison);
	return comparison.why;
}
