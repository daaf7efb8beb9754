// One run of candil-loader: start it, wait for its one message, and never trust more than its seals.
#ifndef CANDIL_FRONT_LOADER_H
#define CANDIL_FRONT_LOADER_H

#include <stdint.h>

#include "server/base/ipc.h"
#include "server/front/child.h"
#include "server/front/source.h"

// How it ended, called once and from the loop: loaded->error says if well. `blob` is a sealed memfd of
// loaded->info.blob_bytes bytes that the callee owns, -1 on failure. Strings are clean, counts within bounds. The loader may
// be started again.
struct loader;
typedef void loader_done(void *owner, const struct ipc_loaded *loaded, int blob);

struct loader {
	struct loop *loop;
	struct children *children;
	struct child child;
	struct loop_timer timer;
	loader_done *done;
	void *owner;
};

void loader_init(struct loader *loader, struct children *children, loader_done *done, void *owner);

// Start `libexec`/candil-loader on a file. It has LIMIT_LOAD_SECONDS.
enum status loader_start(struct loader *loader, const char *libexec, const struct source *source, candil_UpAxis up,
			 double metres_per_unit, struct error *err);

// Kill it if it runs; `done` is not called.
void loader_stop(struct loader *loader);

#endif
