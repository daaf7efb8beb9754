// One build of a model's voxels, read back: shared by the tests of voxels, each a cmocka program.
#ifndef CANDIL_TESTS_VOXEL_RESULT_H
#define CANDIL_TESTS_VOXEL_RESULT_H

#include "server/worker/technique/voxel/voxels.h"
#include "tests/gpu/voxel_model.h"

extern uint64_t device_bytes, device_budget; // what the device counts and may
extern struct gl_device *device;
extern const struct plan everything; // all effects

// Open the device; false if there is none. voxel_test_end closes it; the number of things that went wrong: messages of the
// driver, bytes that were not given back.
bool voxel_test_begin(void);
int voxel_test_end(void);

// What one build left, on the host.
struct result {
	struct voxel_grid grid;
	uint32_t words;
	uint32_t *bits; // two a word: bits, entries before them
	uint32_t *parts[VOXEL_PARTS]; // four words an entry
	uint64_t bytes;
};

enum status try_build(struct model *model, uint32_t resolution, bool cube, uint32_t slice_us, struct result *result,
		      struct error *err);
struct result build(struct model *model, uint32_t resolution); // fails the test where it fails
void result_finish(struct result *result);

bool is_marked(const struct result *result, uint32_t bit);
uint32_t entry_of(const struct result *result, uint32_t bit);

// Component c of a part (BIND_VOXEL_PLACE + part) of an entry, a float.
double real(const struct result *result, int part, uint32_t entry, int c);
double projection(const struct result *result, uint32_t entry, int axis, int negative); // side²
double area_of(const struct result *result); // side², of all entries

// Bit for bit; the places only if `places`.
void assert_same(const struct result *a, const struct result *b, bool places);

// A square of side 2 about the z axis.
void add_wall(struct model *model, double z, uint32_t material);

#endif
