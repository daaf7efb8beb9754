#include "server/worker/gl/settle.h"

#include <epoxy/gl.h>

#include "server/worker/gl/program.h"
#include "shaders/gl/settle_comp.h"
#include "shaders/shared/settle.h"

static const struct gl_source settle_source = {.name = "settle", .compute = source_settle_comp};

enum status gl_settle_prepare(struct gl_device *d, struct error *err)
{
	const struct gl_defines none = {0};
	struct gl_program *program;
	if (!d->software || d->settle)
		return STATUS_OK;
	enum status s = gl_program_get(d, &settle_source, &none, &program, err);
	if (s != STATUS_OK)
		return s;
	gl_program_hold(program);
	glCreateTextures(GL_TEXTURE_2D, 1, &d->settle_texture);
	glTextureStorage2D(d->settle_texture, 1, GL_R8, 1, 1);
	glTextureParameteri(d->settle_texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTextureParameteri(d->settle_texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
	d->settle = program;
	gl_settle(d);
	return gl_wait(d, "compiling", err);
}

void gl_settle(struct gl_device *d)
{
	if (!d->settle)
		return;
	glUseProgram(d->settle->name);
	glBindTextureUnit(SETTLE_UNIT, d->settle_texture);
	glBindImageTexture(0, d->settle_texture, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R8);
	glUniform1ui(0, 0);
	glDispatchCompute(1, 1, 1);
}

void gl_settle_finish(struct gl_device *d)
{
	gl_program_release(d->settle);
	d->settle = NULL;
	if (d->settle_texture)
		glDeleteTextures(1, &d->settle_texture);
	d->settle_texture = 0;
}
