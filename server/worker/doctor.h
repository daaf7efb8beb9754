// `candil-worker --doctor`: what devices there are and what holds of the fence, which has been put up, as JSON on standard
// output, for `candil doctor`.
#ifndef CANDIL_WORKER_DOCTOR_H
#define CANDIL_WORKER_DOCTOR_H

struct device_options;
struct worker_fence;

// Exit status: 0 if a render could work, 5 if no device serves.
int doctor(const struct device_options *options, struct worker_fence *fence);

#endif
