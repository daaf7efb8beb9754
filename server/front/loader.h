// One run of candil-loader: start it, wait for its one message, and never trust more than its seals.
//
// For the front's one thread (loop.h).
#ifndef CANDIL_FRONT_LOADER_H
#define CANDIL_FRONT_LOADER_H

#include <stdbool.h>
#include <stdint.h>

#include "server/base/ipc.h"
#include "server/front/child.h"
#include "server/front/options.h"
#include "server/front/source.h"
#include "server/front/watch.h"

// How a run ended: called once a start, from the loop. loaded->error says whether it went well; `loaded` is good for the
// length of the call, its strings are clean and its counts within bounds. `blob` is a sealed memfd of
// loaded->info.blob_bytes bytes and becomes the callee's; -1 on failure. The loader may be started again from within the
// call.
typedef void loader_done(void *owner, const struct ipc_loaded *loaded, int blob);

struct loader {
	struct loop *loop;
	struct children *children;
	const struct options *options;
	struct child child;
	struct watch watch;
	uint64_t end_us; // when it has had all its time
	loader_done *done;
	void *owner;
};

// No run yet. `children`, `options` and `owner` must outlive the loader.
void loader_init(struct loader *loader, struct children *children, const struct options *options, loader_done *done,
		 void *owner);

// Start candil-loader on a file of `source`, which stays the caller's. `metres_per_unit` is that of a file which does not
// state its own. `images`: a scene that has some can be loaded; without, the loader starts sooner, and of such a scene says
// that it wants them. The run has LIMIT_LOAD_SECONDS of processor time and LIMIT_LOAD_CLOCK_SECONDS in all, and is over
// before if it hangs: is still (pulse.h) for options->hang_s. `done` tells what came of it. Failures, without a call of
// `done`: STATUS_INTERNAL, STATUS_MEMORY.
enum status loader_start(struct loader *loader, const struct source *source, candil_UpAxis up, double metres_per_unit,
			 bool images, struct error *err);

// Kill it if it runs; `done` is not called. Does not wait for its end.
void loader_stop(struct loader *loader);

#endif
