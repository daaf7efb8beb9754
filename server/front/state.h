// What the daemon is made of. For service.c, which is its life, and dispatch.c, which answers its messages, alone.
#ifndef CANDIL_FRONT_STATE_H
#define CANDIL_FRONT_STATE_H

#include "server/base/fence.h"
#include "server/front/cache.h"
#include "server/front/capacity.h"
#include "server/front/channel.h"
#include "server/front/jobs/jobs.h"
#include "server/front/quotes/quotes.h"
#include "server/front/scenes.h"
#include "server/front/session.h"
#include "server/front/worker.h"

struct service {
	const struct options *options;
	struct capacity capacity;
	struct cache cache;
	struct fence_report fence; // what of it has been put up
	struct loop *loop;
	struct listener *listener; // NULL: none
	int signal_fd;
	int scene_root; // O_PATH; -1: none
	struct children children;
	struct sessions sessions;
	struct scenes scenes;
	struct jobs jobs;
	struct worker worker;
	struct quotes quotes;
	struct loop_timer accept_pause, again, departure;
	uint64_t started_us;
	bool warms; // scenes are being made ready (warm.c)
	struct session *warming; // for that; NULL: none, or it has ended
	unsigned warm_next; // the next of the scenes of the options that it looks at
	bool leaving; // a signal came
	bool stop;
	struct error own_failure; // of a --scene; code != OK: the daemon ends with it
};

#endif
