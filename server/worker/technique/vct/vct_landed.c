#include "server/worker/technique/vct/vct_landed.h"

#include <epoxy/gl.h>

#include "shaders/shared/vct.h"

enum { VIEW_WORDS, VIEW_PLACE, VIEW_ALBEDO, VIEW_EMISSION, VIEW_SENT };

static const struct {
	GLenum format;
	unsigned unit;
} kinds[VCT_LANDED_VIEWS] = {[VIEW_WORDS] = {GL_R32UI, VCT_WORDS_UNIT},
			     [VIEW_PLACE] = {GL_RGBA32UI, VCT_PLACE_UNIT},
			     [VIEW_ALBEDO] = {GL_RGBA32UI, VCT_ALBEDO_UNIT},
			     [VIEW_EMISSION] = {GL_RGBA32UI, VCT_EMISSION_UNIT},
			     [VIEW_SENT] = {GL_RGBA32F, VCT_SENT_UNIT}};

// Mesa 22's software driver takes the second byte of a texel buffer's size for a number of levels (lp_state_sampler.c), and
// compiles other code where it is 0. So what stands for buffers to come is like them: those of entries, of many sizes,
// rarely have a 0 there; the grid's words, a power of two and one more, mostly do.
#define NONE_WORDS 96
#define NONE_WORDS_PLAIN 3

static uint64_t none_words_of(const struct voxel_grid *grid)
{
	const uint64_t bytes = 8ull * voxel_grid_words(grid);
	return bytes >> 8 & 255 ? NONE_WORDS : NONE_WORDS_PLAIN;
}

enum status vct_landed_init(struct vct_landed *l, struct gl_device *device, const struct voxel_grid *grid, struct error *err)
{
	static const uint32_t none[NONE_WORDS];
	*l = (struct vct_landed){0};
	enum status s = gl_texels_init(&l->none_words, device, GL_R32UI, none_words_of(grid), none, err);
	if (s == STATUS_OK)
		s = gl_texels_init(&l->none_uints, device, GL_RGBA32UI, NONE_WORDS, none, err);
	if (s == STATUS_OK)
		s = gl_texels_init(&l->none_floats, device, GL_RGBA32F, NONE_WORDS, none, err);
	if (s != STATUS_OK)
		vct_landed_finish(l);
	return s;
}

enum status vct_landed_view(struct vct_landed *l, const struct voxels *voxels, const struct gl_buffer *sent,
			    struct error *err)
{
	const struct gl_buffer *buffers[VCT_LANDED_VIEWS] = {
	    [VIEW_WORDS] = &voxels->words,
	    [VIEW_PLACE] = &voxels->parts[0],
	    [VIEW_ALBEDO] = &voxels->parts[BIND_VOXEL_ALBEDO - BIND_VOXEL_PLACE],
	    [VIEW_EMISSION] = &voxels->parts[BIND_VOXEL_EMISSION - BIND_VOXEL_PLACE],
	    [VIEW_SENT] = sent};
	enum status s = STATUS_OK;
	for (unsigned i = 0; s == STATUS_OK && i < VCT_LANDED_VIEWS; i++) {
		gl_texels_finish(&l->views[i]);
		s = gl_texels_view(&l->views[i], l->none_words.device, kinds[i].format, buffers[i], err);
	}
	return s;
}

void vct_landed_bind(const struct vct_landed *l, const struct voxels *voxels)
{
	glBindBufferBase(GL_UNIFORM_BUFFER, UNIFORM_VOXEL_GRID, voxels->grid_block.name);
	for (unsigned i = 0; i < VCT_LANDED_VIEWS; i++) {
		const struct gl_texels *none = kinds[i].format == GL_R32UI      ? &l->none_words
					       : kinds[i].format == GL_RGBA32UI ? &l->none_uints
										: &l->none_floats;
		gl_texels_bind(l->views[i].texture ? &l->views[i] : none, kinds[i].unit);
	}
	if (l->sky)
		gl_texels_bind(&l->sky->rows, VCT_SKY_ROWS_UNIT);
}

void vct_landed_finish(struct vct_landed *l)
{
	for (unsigned i = 0; i < VCT_LANDED_VIEWS; i++)
		gl_texels_finish(&l->views[i]);
	gl_texels_finish(&l->none_words);
	gl_texels_finish(&l->none_uints);
	gl_texels_finish(&l->none_floats);
	*l = (struct vct_landed){0};
}
