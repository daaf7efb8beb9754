// The scene that a command is about, and the daemon that has it: one that runs already, or a private one that is started for
// the command and ends with its connection.
#ifndef CANDIL_CLI_TARGET_H
#define CANDIL_CLI_TARGET_H

#include <sys/types.h>

#include "clients/cli/cli.h"

// What goes with a scene, found in the same way.
struct target_part {
	char name[64]; // in the daemon; "": there is none
	char hash[40]; // likewise
	bool temporary; // it was loaded for this command
	bool solution; // it is a file of patches with their light, and has no form factors
};

struct target {
	candil_client *client;
	pid_t private_daemon; // 0: none was started
	char scene[64]; // name in the daemon
	bool temporary; // the scene was loaded for this command
	struct target_part picture; // of the surroundings
	struct target_part imported;
	struct candil_scene_info info; // last: it outlives the rest
};

// Find `scene` and describe it. It is looked for among the daemon's scenes first, and one that is being loaded is waited
// for; else it is a file, which is loaded. `how` says how a file is read; its name and paths are ignored. If `address` is
// NULL and no daemon answers at the default one, a private daemon is started for a file. Fails with CANCELLED after an
// interrupt, and as candil_connect, candil_describe and candil_load do. target_close must follow in any case.
candil_status target_open(struct target *target, const char *address, const char *scene,
			  const struct candil_load_request *how, struct candil_error *error);

// Find what request->environment and request->imported name in the same way, in the daemon of an open target, and replace
// their names by those that they have there. Does nothing if the request names none.
candil_status target_parts(struct target *target, struct candil_render_request *request, struct candil_error *error);

// Unload what was loaded for the command, disconnect, and wait for a private daemon to end. `info` stays. A second call does
// nothing.
void target_close(struct target *target);

#endif
