#include "server/worker/gl/texture.h"

#include <epoxy/gl.h>

#include "server/worker/gl/program.h"

// Bytes of a texel, and the format and type in which zeros are handed to the driver.
static const struct texel {
	GLenum format;
	uint32_t bytes;
	GLenum layout, type;
} texels[] = {
    {GL_R8, 1, GL_RED, GL_UNSIGNED_BYTE},
    {GL_RGBA8, 4, GL_RGBA, GL_UNSIGNED_BYTE},
    {GL_RGBA8_SNORM, 4, GL_RGBA, GL_BYTE},
    {GL_RGB10_A2, 4, GL_RGBA, GL_UNSIGNED_BYTE},
    {GL_R11F_G11F_B10F, 4, GL_RGB, GL_FLOAT},
    {GL_RGB9_E5, 4, GL_RGB, GL_FLOAT},
    {GL_R16F, 2, GL_RED, GL_FLOAT},
    {GL_RG16F, 4, GL_RG, GL_FLOAT},
    {GL_RGBA16, 8, GL_RGBA, GL_UNSIGNED_SHORT},
    {GL_RGBA16F, 8, GL_RGBA, GL_FLOAT},
    {GL_R32F, 4, GL_RED, GL_FLOAT},
    {GL_RG32F, 8, GL_RG, GL_FLOAT},
    {GL_RGBA32F, 16, GL_RGBA, GL_FLOAT},
    {GL_R32UI, 4, GL_RED_INTEGER, GL_UNSIGNED_INT},
    {GL_RG32UI, 8, GL_RG_INTEGER, GL_UNSIGNED_INT},
    {GL_RGBA32UI, 16, GL_RGBA_INTEGER, GL_UNSIGNED_INT},
    {GL_DEPTH_COMPONENT32F, 4, GL_DEPTH_COMPONENT, GL_FLOAT},
};

static const struct texel *texel_of(GLenum format)
{
	for (unsigned i = 0; i < sizeof texels / sizeof *texels; i++)
		if (texels[i].format == format)
			return &texels[i];
	return NULL;
}

static bool is_layered(GLenum target)
{
	return target == GL_TEXTURE_2D_ARRAY || target == GL_TEXTURE_CUBE_MAP_ARRAY;
}

static uint32_t levels_of(const struct gl_texture_desc *t)
{
	uint32_t side = t->width > t->height ? t->width : t->height;
	if (t->target == GL_TEXTURE_3D && t->depth > side)
		side = t->depth;
	uint32_t n = 1;
	while (side >>= 1)
		n++;
	return t->levels == 0 || t->levels > n ? n : t->levels;
}

static uint32_t at_level(uint32_t side, uint32_t level)
{
	return side >> level > 0 ? side >> level : 1;
}

uint64_t gl_texture_bytes(const struct gl_texture_desc *t)
{
	const struct texel *texel = texel_of(t->format);
	uint64_t texel_count = 0;
	for (uint32_t l = 0; l < levels_of(t); l++)
		texel_count += (uint64_t)at_level(t->width, l) * at_level(t->height, l) *
			       (t->target == GL_TEXTURE_3D ? at_level(t->depth, l) : t->depth);
	return texel ? texel_count * texel->bytes : 0;
}

static bool sides_fit(const struct gl_device *d, const struct gl_texture_desc *t)
{
	const uint32_t most = t->target == GL_TEXTURE_3D ? d->volume_side_max : d->image_side_max;
	return t->width <= most && t->height <= most && (t->target != GL_TEXTURE_3D || t->depth <= most);
}

enum status gl_texture_init(struct gl_texture *t, struct gl_device *d, const struct gl_texture_desc *desc, struct error *err)
{
	*t = (struct gl_texture){0};
	const uint64_t bytes = gl_texture_bytes(desc);
	if (bytes == 0)
		return error_set(err, STATUS_INTERNAL, "there is no such texture format");
	if (!sides_fit(d, desc))
		return error_set(err, STATUS_MEMORY, "the OpenGL device has no texture of %u x %u x %u texels", desc->width,
				 desc->height, desc->depth);
	enum status s = gl_reserve(d, bytes, err);
	if (s != STATUS_OK)
		return s;
	t->device = d;
	t->desc = *desc;
	t->desc.levels = levels_of(desc);
	t->bytes = bytes;
	*d->bytes += bytes;
	const GLsizei w = (GLsizei)desc->width, h = (GLsizei)desc->height, levels = (GLsizei)t->desc.levels;
	glCreateTextures(desc->target, 1, &t->name);
	if (desc->target == GL_TEXTURE_3D || is_layered(desc->target))
		glTextureStorage3D(t->name, levels, desc->format, w, h, (GLsizei)desc->depth);
	else
		glTextureStorage2D(t->name, levels, desc->format, w, h);
	glTextureParameteri(t->name, GL_TEXTURE_MIN_FILTER, levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
	glTextureParameteri(t->name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	glTextureParameteri(t->name, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
	glTextureParameteri(t->name, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	glTextureParameteri(t->name, GL_TEXTURE_WRAP_R, GL_CLAMP_TO_EDGE);
	gl_texture_clear(t);
	s = gl_check(d, "making a texture", err);
	if (s != STATUS_OK)
		gl_texture_finish(t, d);
	return s;
}

void gl_texture_finish(struct gl_texture *t, struct gl_device *d)
{
	if (t->name) {
		glDeleteTextures(1, &t->name);
		*d->bytes -= t->bytes;
	}
	*t = (struct gl_texture){0};
}

void gl_texture_clear(const struct gl_texture *t)
{
	const struct texel *texel = texel_of(t->desc.format);
	glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
	for (uint32_t l = 0; l < t->desc.levels; l++)
		glClearTexImage(t->name, (GLint)l, texel->layout, texel->type, NULL);
}

void gl_texture_linear(const struct gl_texture *t, bool mips)
{
	glTextureParameteri(t->name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTextureParameteri(t->name, GL_TEXTURE_MIN_FILTER,
			    t->desc.levels == 1 ? GL_LINEAR
			    : mips              ? GL_LINEAR_MIPMAP_LINEAR
						: GL_LINEAR_MIPMAP_NEAREST);
}

// 1 or 0.
static uint64_t is_power_of_two(uint32_t x)
{
	return (x & (x - 1)) == 0;
}

// Tell the program in use what it gets: llvmpipe's lp_static_texture_state has a texture's format, target, whether its sides
// are powers of two and whether it has levels.
static void tell_shape(const struct gl_texture *t, unsigned unit, bool image)
{
	const struct gl_texture_desc *d = &t->desc;
	const uint64_t sides = is_power_of_two(d->width) | is_power_of_two(d->height) << 1 | is_power_of_two(d->depth) << 2;
	const uint64_t more = sides | (uint64_t)(d->levels > 1) << 3 | (uint64_t)image << 4 | (uint64_t)unit << 8;
	if (t->device)
		gl_shape(t->device, more << 32 | (uint64_t)d->target << 16 | d->format);
}

void gl_texture_bind(const struct gl_texture *t, unsigned unit)
{
	tell_shape(t, unit, false);
	glBindTextureUnit(unit, t->name);
}

void gl_texture_bind_image(const struct gl_texture *t, unsigned unit, uint32_t level, unsigned access)
{
	tell_shape(t, unit, true);
	glBindImageTexture(unit, t->name, (GLint)level, GL_TRUE, 0, access, t->desc.format);
}
