// Is a process at work? One that burns processor time, or could if a processor were free, or waits for a disk, is slow at
// worst. One that does none of these for a while hangs: it sleeps, or is stopped. So a busy machine makes nobody look as if
// he hung, which a limit of the clock does.
//
// Whoever waits for a process looks at it at even intervals, PULSE_LOOKS of them in the time that it may be still. Looks are
// counted, not seconds: those that the watcher itself misses, because it has no processor or is stopped, count for nobody.
//
// Any thread; one pulse belongs to one thread. Nothing fails: of a process that has ended or cannot be seen, nothing is
// seen.
#ifndef CANDIL_BASE_PULSE_H
#define CANDIL_BASE_PULSE_H

#include <stdint.h>
#include <sys/types.h>

#define PULSE_LOOKS 16u

struct pulse {
	pid_t pid;
	unsigned still; // looks in a row that found it idle
	uint64_t burnt_us; // processor time of all its threads up to the last look
	uint64_t looked_us; // when that was
};

// Begin to watch a process: it counts as at work so far.
void pulse_begin(struct pulse *pulse, pid_t pid);

// Look at it once more. Returns for how long it has worked since the last look, in microseconds: its processor time, but no
// more than has passed, so that many threads at a time count as one. What hangs in a loop works for ever; on a busy machine
// this time passes more slowly than the clock's.
uint64_t pulse_look(struct pulse *pulse);

#endif
