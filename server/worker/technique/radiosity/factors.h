// Form factors of a scene's elements as a sparse matrix in device memory: row i, column j holds F_ij, the share of light
// that leaves element i (spread evenly over it, by Lambert's law over directions) and arrives at element j, on its way also
// by mirrors (extended form factors: Sillion and Puech 1989, "A general two-pass method integrating specular and diffuse
// reflection"). By reciprocity it is what radiosity gathers with: H_i = Σ_j F_ij B_j. Vulkan; device's thread only.
//
// Rows come in any order, a batch at a time, and only those that somebody asks for: a row that was never put is empty. They
// lie in blocks of at most FACTORS_BLOCK_BYTES, each a buffer, because devices bind no more (maxStorageBufferRange). What a
// row holds does not depend on the batch that it came with. Columns of a row ascend.
#ifndef CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_H
#define CANDIL_WORKER_TECHNIQUE_RADIOSITY_FACTORS_H

#include "server/base/error.h"
#include "server/worker/vk/buffer.h"
#include "shaders/shared/layout.h"

#define FACTORS_BLOCK_BYTES (128u << 20)

// Every row begins at a multiple of so many entries of its block, and those between its end and the next multiple are column
// 0 with value 0: a shader may read a row by four.
#define FACTORS_ALIGN 4u

// A block of consecutive entries, those of a row side by side.
struct factors_block {
	struct buffer columns; // uint
	struct buffer values; // float
	uint32_t entries; // in use, a multiple of FACTORS_ALIGN
};

// Where a row is.
struct factors_row {
	uint32_t block; // NONE: it was never put
	uint32_t first, count; // entries of the block
	float escaped; // share of light that meets nothing: the background's
	float cut; // share that a limit of mirror bounces cut off
};

// The matrix. Owned by its maker.
struct factors {
	struct device *device;
	uint32_t side; // rows, and columns
	struct factors_row *rows; // host
	struct factors_block *blocks;
	uint32_t block_count;
	uint64_t entries; // of all rows
	uint64_t holes; // entries of blocks that rows which are gone have left
	uint64_t changes; // grows whenever rows come, go or move: who goes through them in slices looks for it
	uint32_t block_entries; // that a block holds at most; a test may lower it
	bool packs_on_host; // the device's memory is the host's, and factors_put_dense does it there; a test may clear it
};

// Make an empty matrix. STATUS_MEMORY. On failure nothing is left.
enum status factors_init(struct factors *factors, struct device *device, uint32_t side, struct error *err);

// Free it. Zeroed is fine.
void factors_finish(struct factors *factors);

// What a row is put with.
struct factors_put {
	uint32_t element;
	float escaped, cut;
};

// Take `count` rows out of a dense buffer on the device: row k of it, `side` words of fixed point (`unit` of them are a
// factor of 1), becomes the row rows[k].element, which must be empty. What is not zero is kept, as (float)word * (float)(1 /
// unit), and these rows of the buffer are zero afterwards, ready for the next batch. STATUS_MEMORY: there is no room, and
// nothing of the batch was taken; STATUS_DEVICE; STATUS_INTERNAL if a row is no row, or not empty.
//
// A software device's memory is the host's, and there the host does it: 25,800 words with 1,500 that are not zero take it a
// quarter of the time that the shader takes on such a device.
enum status factors_put_dense(struct factors *factors, const struct buffer *dense, double unit,
			      const struct factors_put *rows, uint32_t count, struct error *err);

// Put one row from host memory, its columns ascending; it replaces one that was there. Fails as factors_put_dense;
// STATUS_INTERNAL if the columns do not ascend or are none, or a value is negative or no number.
enum status factors_put_row(struct factors *factors, const struct factors_put *row, const uint32_t *columns,
			    const float *values, uint32_t count, struct error *err);

// Take rows over from another matrix on the device, all in one submission. They must be there, and empty here.
// STATUS_MEMORY, STATUS_DEVICE: none was taken.
enum status factors_take(struct factors *factors, const struct factors *from, const uint32_t *elements, uint32_t count,
			 struct error *err);

// Copy a row to host memory: *columns and *values, which the caller frees, have factors->rows[i].count elements (NULL:
// none).
enum status factors_read_row(const struct factors *factors, uint32_t i, uint32_t **columns, float **values,
			     struct error *err);

// Make a row one that was never put. Its place in a block stays unused until the matrix is compacted, which the functions
// that put rows do once more than half of it is holes.
void factors_remove_row(struct factors *factors, uint32_t i);

// Move all rows together, in their order, into blocks without holes. Needs memory for the blocks old and new. STATUS_MEMORY,
// STATUS_DEVICE; on failure the matrix is as it was.
enum status factors_compact(struct factors *factors, struct error *err);

// About the most that so many entries in so many rows will take, in bytes: what is left free at the ends of blocks counts.
uint64_t factors_bytes_most(uint64_t entries, uint64_t rows);

// Device memory of it now, in bytes.
uint64_t factors_bytes(const struct factors *factors);

#endif
