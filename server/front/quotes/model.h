// What is known of time and error: records of frames and pilots, and the habits of a device. Values alone: no clock, no
// file, no process.
//
// A record holds parts, each of them a logarithm: of a time divided by what it grows with, or of an error. A part of a
// request is predicted from five groups of records, the nearest first: frames of the same view and settings, pilots of
// them, anything else of the same scene and technique, other scenes, and a guess that needs none. Work that is made once for
// a scene knows no view. What its rows cost is heard of records alone that made them the same way, and pictures that were
// made another way speak as those of other scenes. Errors of a technique with such work are those of its settings and of the
// scene's light: others tell nothing, and the error is unknown. A group's members are first carried to the size and samples
// of the request by the drift, which is learned: what a part changes by with each doubling. Of other scenes each speaks
// once, however many records it has, and so does each view of the same scene. A group's mean counts by the inverse of its
// variance, which is that of its members and that of the group: how far frames have lain from what the group said (Cochran,
// Problems arising in the analysis of a series of similar experiments, 1937); but one that is further than that from what
// nearer groups say counts by that distance. Variances and drift are learned from frames, for each device, technique and
// part: of how far scenes and views are apart from the first frame of each.
//
// Intervals. The logarithm of a time or an error is taken as normal. 1.645 deviations hold 90 %, times a stretch, which is
// learned apart by the nearest group that knew something: each frame corrects it by exp(0.2 · 0.9) if what came out lay
// outside, else by exp(−0.2 · 0.1). That tracks the quantile (Angelopoulos, Candès and Tibshirani, Conformal PID control
// for time series prediction, NeurIPS 2023, section 2.1, on the logarithm of the width): in the long run nine of ten lie
// inside, as far as a stretch between 0.5 and 4 does it. What a record has measured of its own deviation no stretch narrows:
// else scenes that are easy would vouch for one that is not.
//
// For the front's one thread. Nothing fails. Times are microseconds.
#ifndef CANDIL_FRONT_QUOTES_MODEL_H
#define CANDIL_FRONT_QUOTES_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/limits.h"
#include "protocol/names.h"
#include "server/base/estimate.h"
#include "server/base/work.h"

// The parts of a record. Each is the logarithm of:
enum quote_part {
	QUOTE_FIXED, // µs of a frame beside all stages
	QUOTE_PIXEL, // µs for a pixel, whatever the samples
	QUOTE_SAMPLE, // µs for a sample of a pixel
	QUOTE_ENCODE, // µs for a byte of the file, by image_estimate
	QUOTE_SETUP, // µs of what is made once for a scene, without the parts of its work, of which each has µs for a unit:
	QUOTE_CUT,
	QUOTE_LIGHT,
	QUOTE_ROWS,
	QUOTE_SOLVE,
	QUOTE_COLD, // µs of compiling
	QUOTE_ERROR, // relMSE × samples of a technique with noise, else relMSE
	QUOTE_PARTS
};

// The groups of records beside a guess.
enum quote_group { QUOTE_FRAMES, QUOTE_PILOTS, QUOTE_SCENE, QUOTE_OTHERS, QUOTE_GROUPS };

// What a record is about, hashed.
struct quote_key {
	uint64_t where; // the device, its driver, candil's version and the layout of its programs' messages
	uint64_t scene; // with the picture of its surroundings
	uint64_t look; // technique and options
	uint64_t view; // camera and all else that shows, but the size and the samples
	uint64_t light; // the same without the camera
	uint64_t rows, picture; // what a row's cost, and a pixel's, depends on beside them (server/base/work.h); 0: not told
};

// One frame, or one technique's part of a pilot.
struct quote_record {
	struct quote_key key;
	uint64_t stamp; // of the clock on the wall, µs: no two records of a daemon have the same
	uint32_t technique; // candil_Technique, one with TECHNIQUE_RENDERS
	uint32_t pilot; // 1, or 0: a frame. One that knows no part could not render it
	uint32_t pixels, samples; // above 0
	uint32_t known; // bits 1 << enum quote_part
	float part[QUOTE_PARTS]; // those that are known
	float spread; // deviation of part[QUOTE_ERROR]
	float edges; // share of part[QUOTE_ERROR], 0 … 1, that more samples mend: edges, of which a larger picture has fewer
};

// Sums over what was learned of one part of one technique.
struct quote_habit {
	double pp, ps, ss, p, s; // normal equations of the drift: octaves of pixels and samples, and the change
	double count[QUOTE_GROUPS], sum[QUOTE_GROUPS], squares[QUOTE_GROUPS]; // what came out less what the group said
};

// A device's.
struct quote_habits {
	uint64_t where; // 0: a free place
	struct quote_habit habit[TECHNIQUE_COUNT][QUOTE_PARTS];
	double stretch[TECHNIQUE_COUNT][2][QUOTE_GROUPS + 1]; // of time and error, by the nearest group that knew; 0: 1
};

// Everything. Zeroed, it is empty.
struct quote_model {
	struct quote_habits habits[LIMIT_QUOTE_DEVICES];
	uint32_t count; // of records, at most LIMIT_QUOTE_RECORDS
	uint32_t oldest; // once there are so many
	struct quote_record records[LIMIT_QUOTE_RECORDS]; // in the order of their coming, from `oldest` on
};

// What is to be predicted.
struct quote_query {
	struct quote_key key;
	uint32_t technique;
	bool software; // the device is a processor
	double pixels, samples, bytes; // of the file
	double picture; // units of the key's `picture` that a sample of a pixel counts as, above 0
	double work[WORK_PARTS], doubt[WORK_PARTS]; // units that are to be made, and the deviations of their logarithms
	bool setup; // what else is made once for a scene is to be made
	bool cold; // programs are to be compiled
};

struct quote_prediction {
	double us, us_low, us_high; // on an idle device, without cold_us
	double work_us; // of `us`: the parts of the work that is made once for a scene
	double cold_us; // 0 unless query->cold
	struct estimate error; // unknown where errors of other settings and lights tell nothing of it
	double measured_high; // upper end of what a frame by noise will measure of its own error, likely
	enum quote_group nearest[2]; // that knows something of the time and of the error; QUOTE_GROUPS: none
	uint32_t records; // of the scene
};

// Predict time and error.
struct quote_prediction quote_predict(const struct quote_model *model, const struct quote_query *query);

// Set a part of a record to the logarithm of `value`; not known if that is not finite or not above 0.
void quote_set_part(struct quote_record *record, enum quote_part part, double value);

// Learn from a record and keep it. `query` is what quote_predict was asked, or would have been, and `us` the whole time of
// the frame without what is cold; query NULL: a pilot. us 0: not known.
void quote_learn(struct quote_model *model, const struct quote_record *record, const struct quote_query *query, double us);

// How many records of the scene there are that know anything, and how many that know a part of that look, of that look and
// light, and of that view and look. Of a view a pilot counts whatever it knows: another would tell no more.
uint32_t quote_count_scene(const struct quote_model *model, const struct quote_key *key);
uint32_t quote_count_look(const struct quote_model *model, const struct quote_key *key, enum quote_part part);
uint32_t quote_count_light(const struct quote_model *model, const struct quote_key *key, enum quote_part part);
uint32_t quote_count_view(const struct quote_model *model, const struct quote_key *key, enum quote_part part);

// Whether the newest record of the look and scene is that of a pilot that knows nothing, for its technique could not.
bool quote_refused(const struct quote_model *model, const struct quote_key *key);

// Whether a record may be taken from a file.
bool quote_record_holds(const struct quote_record *record);
bool quote_habits_hold(const struct quote_habits *habits);

// The habits of a device: its own, else a free place, else that of the device whose newest record is the oldest.
struct quote_habits *quote_make_habits(struct quote_model *model, uint64_t where);

// Add a record without learning from it.
void quote_keep(struct quote_model *model, const struct quote_record *record);

#endif
