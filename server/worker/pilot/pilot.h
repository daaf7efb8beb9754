// Pilots: small pictures of a request's view, of which a quote learns what its own will cost and how good it will be. A
// pilot goes through the seam of technique.h as a job does, with a seed of its own, and no picture of it is kept. Device's
// thread only.
#ifndef CANDIL_WORKER_PILOT_PILOT_H
#define CANDIL_WORKER_PILOT_PILOT_H

#include <stdbool.h>
#include <stdint.h>

#include "candil.pb.h"
#include "protocol/names.h"
#include "server/base/error.h"
#include "server/base/pilot.h"

struct devices;
struct resident_scene;

// What is looked at. The pointers stay the caller's.
struct pilot {
	struct devices *devices;
	struct resident_scene *scene;
	struct resident_scene *environment; // NULL: none
	struct resident_scene *imported; // NULL: none
	const candil_Render *render; // a checked one; its technique, samples and end do not count
	uint32_t techniques; // bits 1 << candil_Technique
	uint32_t told; // the same: those whose work is told, whether or not there are pictures by them
	uint32_t budget_us; // of work of each technique, beside compiling and what is made once for a scene
	uint32_t try_us; // for which some of that is tried out; 0: it is counted
	uint64_t end_us; // clock_us() from which on no picture is begun or gone on with
	uint64_t memory; // bytes of the device that it may take
	bool (*make_room)(void *user); // after STATUS_MEMORY: whether there is more than before, and another try is worth it
	// Whether nobody wants more of it: asked between slices and before each picture. If so, that picture is given up.
	bool (*is_ended)(void *user);
	void *user;
};

// One of its pictures.
struct pilot_picture {
	candil_Technique technique;
	double pixels; // about so many, and none more than the request has
	uint32_t samples;
	uint32_t half; // 0 or 1: of one number are the same bits, of the two the noise is independent
};

// What is rendered for a picture of the request `asked`: as wide for its height, without an end, a target or channels, and
// without options that the picture's technique does not know.
void pilot_request(const candil_Render *asked, const struct pilot_picture *picture, candil_Render *render);

// How long one picture may take before it is given up: what its budget may be overrun by, and 10 s for what is beside it.
uint64_t pilot_patience_us(uint32_t budget_us);

// What two independent pictures of as many samples say together of the error of either: their mean, without an upper end if
// one has none; of one that is unknown the other's.
struct estimate pilot_mean(const struct estimate *a, const struct estimate *b);

// Look by each technique. One that cannot render the request has `refused` alone; zeroed is one whose first, tiny picture is
// given up, or has no memory, of which another time there may be more. If only the second is, the result is that of the
// first. The bias of techniques without noise is known only if one with noise is looked at, too. Fails as plan_make does if
// the request is wrong, and with STATUS_DEVICE; with STATUS_INTERNAL where devices->code refuses to compile what *cold, a
// technique, needs.
enum status pilot_run(const struct pilot *pilot, struct pilot_result results[TECHNIQUE_COUNT], uint32_t *cold,
		      struct error *err);

// Two independent pictures by a technique with noise, of as many samples each.
struct pilot_reference {
	uint32_t width, height; // pixels
	const float *half[2]; // 3 floats a pixel, row by row
};

// What one sample of a picture of `asked` pixels takes, by those of two pictures without noise, the larger last: each sample
// has a time of its own and one for each pixel. One size alone is taken as if it were all of pixels.
double pilot_sample_us(const double pixels[2], const double us[2], double asked);

// Fill in the shares at edges of the biases of one picture with several samples and of one with a single sample: what more
// samples mend. The latter is held to what the former allows. Without both they stay as they are.
void pilot_edges(struct pilot_bias bias[2]);

// The relMSE of `picture`, without noise and of the same size, beside what the reference tends to. With a and b the halves
// (x − a)(x − b) has the mean (x − r)², whatever their noise. It is divided by ρ² + 0.01, where ρ is the mean of the
// halves and of the pixels around if the halves agree, else that of the pixels around alone: a pixel that is dark by chance
// would count a hundredfold. Halves that disagree are clamped to four times what is around, so that the mean is (x − r)²
// about alone where the noise is strong. The ends are the deviation of the mean over pixels, taken as independent. Unknown
// where the noise hides even its sign.
struct estimate pilot_bias(const float *picture, const struct pilot_reference *reference);

#endif
