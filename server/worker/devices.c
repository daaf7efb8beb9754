#include "server/worker/devices.h"

#include "server/base/clock.h"
#include "server/worker/gl/device.h"
#include "server/worker/gl/program.h"
#include "server/worker/gl/settle.h"
#include "server/worker/vk/device.h"
#include "server/worker/vk/pipeline.h"

enum status devices_gl(struct devices *d, struct gl_device **gl, struct error *err)
{
	enum status s = STATUS_OK;
	if (!d->gl) {
		const struct gl_device_options options = {.uuid = d->vk->info.uuid_bytes,
							  .software = d->vk->info.software,
							  .bytes = &d->vk->bytes,
							  .budget = &d->vk->budget,
							  .wanted = &d->vk->wanted};
		const uint64_t start = clock_us();
		s = gl_device_create(&options, &d->gl, err);
		if (s == STATUS_OK)
			s = gl_settle_prepare(d->gl, err);
		if (s == STATUS_OK)
			d->gl->code = d->vk->code;
		d->open_us += clock_us() - start;
	}
	*gl = d->gl;
	return s;
}

void devices_finish(struct devices *d)
{
	if (d->gl) {
		gl_settle_finish(d->gl);
		gl_program_destroy_all(d->gl);
	}
	if (d->vk)
		pipeline_destroy_all(d->vk);
	if (d->vk && d->vk->code)
		code_list_close(d->vk->code);
	gl_device_destroy(d->gl);
	device_destroy(d->vk);
	*d = (struct devices){0};
}
