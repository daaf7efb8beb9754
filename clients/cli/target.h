// The scene that a command is about, in some daemon: one that runs already, or a private one, started for the call, that
// ends with its connection.
#ifndef CANDIL_CLI_TARGET_H
#define CANDIL_CLI_TARGET_H

#include <sys/types.h>

#include "clients/cli/cli.h"

struct target {
	candil_client *client;
	pid_t private_daemon; // 0: none was started
	char scene[64]; // name in the daemon
	bool temporary; // it was loaded for this call
	char picture[64]; // likewise of the picture of its surroundings; "": there is none
	bool picture_temporary;
	struct candil_scene_info info;
};

// Find `scene` (the name of a loaded one comes first, or of one that is being loaded, which is waited for; then a file) and
// describe it. `how` says how a file is read; its name and file fields are ignored. With no address and no daemon at the
// default one, a private daemon is started for a file. CANCELLED after Ctrl-C. target_close is due in any case.
candil_status target_open(struct target *target, const char *address, const char *scene,
			  const struct candil_load_request *how, struct candil_error *error);

// Find the picture that request->environment names, if it does, in the same way, in the daemon of an open target, and put
// the name that it has there in its place.
candil_status target_surroundings(struct target *target, struct candil_render_request *request, struct candil_error *error);

// Unload what was loaded, disconnect, wait for the private daemon to end.
void target_close(struct target *target);

#endif
