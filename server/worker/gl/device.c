// One context for the whole worker, by EGL without a display server: on that of EGL's devices that has the UUID asked for,
// or else on Mesa's surfaceless platform, which exists wherever software rendering does.
#include "server/worker/gl/device.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/log.h"
#include "server/base/room_need.h"

#define EGL_DEVICES_MAX 16

static bool validation_wanted(void)
{
	const char *v = getenv("CANDIL_VALIDATION");
	return v && !strcmp(v, "1");
}

static void on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar *text,
		       const void *user)
{
	(void)source;
	(void)id;
	(void)length;
	// The extension's signature makes it const; the pointer is the device that set_state handed over.
	struct gl_device *d = (struct gl_device *)(uintptr_t)user;
	if (type != GL_DEBUG_TYPE_ERROR && type != GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR)
		return;
	d->errors++;
	log_line(severity == GL_DEBUG_SEVERITY_NOTIFICATION ? LOG_INFO : LOG_ERROR, "validation: GL: %s", text);
}

static bool context_create(struct gl_device *d, EGLDisplay display)
{
	EGLint major, minor;
	if (!display || !eglInitialize(display, &major, &minor))
		return false;
	const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
				     4,
				     EGL_CONTEXT_MINOR_VERSION,
				     5,
				     EGL_CONTEXT_OPENGL_PROFILE_MASK,
				     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
				     EGL_CONTEXT_OPENGL_DEBUG,
				     validation_wanted() ? EGL_TRUE : EGL_FALSE,
				     EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY,
				     EGL_LOSE_CONTEXT_ON_RESET,
				     EGL_NONE};
	EGLContext context = EGL_NO_CONTEXT;
	if (eglBindAPI(EGL_OPENGL_API))
		context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
	if (context == EGL_NO_CONTEXT || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
		if (context != EGL_NO_CONTEXT)
			eglDestroyContext(display, context);
		eglTerminate(display);
		return false;
	}
	d->display = display;
	d->context = context;
	return true;
}

static void context_destroy(struct gl_device *d)
{
	if (!d->display)
		return;
	eglMakeCurrent(d->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
	eglDestroyContext(d->display, d->context);
	eglTerminate(d->display);
	d->display = NULL;
	d->context = NULL;
}

// Whether the current context runs on the GPU with this UUID.
static bool has_uuid(const uint8_t *uuid)
{
	if (!uuid || !epoxy_has_gl_extension("GL_EXT_memory_object"))
		return false;
	GLint count = 0;
	glGetIntegerv(GL_NUM_DEVICE_UUIDS_EXT, &count);
	for (GLint i = 0; i < count; i++) {
		GLubyte of_device[GL_UUID_SIZE_EXT] = {0};
		glGetUnsignedBytei_vEXT(GL_DEVICE_UUID_EXT, (GLuint)i, of_device);
		if (!memcmp(of_device, uuid, GL_UUID_BYTES))
			return true;
	}
	return false;
}

static bool is_software(EGLDeviceEXT device)
{
	const char *extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
	return extensions && strstr(extensions, "EGL_MESA_device_software");
}

// Open the device that has the UUID asked for, or else the first of the kind asked for.
static bool open_listed(struct gl_device *d, const struct gl_device_options *o)
{
	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
	    !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))
		return false;
	EGLDeviceEXT devices[EGL_DEVICES_MAX];
	EGLint count = 0;
	if (!eglQueryDevicesEXT(EGL_DEVICES_MAX, devices, &count))
		return false;
	EGLint fallback = -1;
	for (EGLint i = 0; i < count; i++) {
		if (is_software(devices[i]) != o->software)
			continue;
		if (fallback < 0)
			fallback = i;
		if (!context_create(d, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL)))
			continue;
		d->same_device = has_uuid(o->uuid);
		if (d->same_device)
			return true;
		context_destroy(d);
	}
	return fallback >= 0 &&
	       context_create(d, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[fallback], NULL));
}

static bool open_surfaceless(struct gl_device *d, const struct gl_device_options *o)
{
	if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless") ||
	    !context_create(d, eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL)))
		return false;
	d->same_device = has_uuid(o->uuid);
	return true;
}

static void look_around(struct gl_device *d)
{
	GLint64 bytes = 0;
	GLint side = 0;
	d->software = strstr((const char *)glGetString(GL_RENDERER), "llvmpipe") != NULL;
	snprintf(d->name, sizeof d->name, "%.60s, OpenGL %.50s", (const char *)glGetString(GL_RENDERER),
		 (const char *)glGetString(GL_VERSION));
	glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
	d->storage_bytes_max = bytes > 0 ? (uint64_t)bytes : 0;
	glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &side);
	d->volume_side_max = (uint32_t)side;
	glGetIntegerv(GL_MAX_TEXTURE_SIZE, &side);
	d->image_side_max = (uint32_t)side;
}

// State that every pass expects and no pass changes: depth is in 0…1 and grows towards the eye (reversed, with an infinite
// far plane), and of equal depths the triangle drawn first stays. All else is as a context begins.
static void set_state(struct gl_device *d)
{
	glCreateVertexArrays(1, &d->vertex_array);
	glBindVertexArray(d->vertex_array);
	glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_GREATER);
	glPixelStorei(GL_PACK_ALIGNMENT, 1);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	if (validation_wanted()) {
		glEnable(GL_DEBUG_OUTPUT);
		glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
		glDebugMessageCallback(on_message, d);
	}
}

enum status gl_device_create(const struct gl_device_options *options, struct gl_device **device, struct error *err)
{
	if (room_need(ROOM_GL_BYTES, "OpenGL", err) != STATUS_OK)
		return STATUS_MEMORY;
	struct gl_device *d = calloc(1, sizeof *d);
	if (!d)
		return error_set(err, STATUS_MEMORY, "out of memory");
	d->bytes = options->bytes;
	d->budget = options->budget;
	d->wanted = options->wanted;
	if (!open_listed(d, options) && !open_surfaceless(d, options)) {
		free(d);
		return error_set(err, STATUS_DEVICE,
				 "no OpenGL 4.5 by EGL without a display: install libegl1 and libgl1-mesa-dri or the GPU's "
				 "own driver; pt needs none");
	}
	look_around(d);
	set_state(d);
	enum status s = gl_check(d, "opening OpenGL", err);
	if (s != STATUS_OK) {
		gl_device_destroy(d);
		return s;
	}
	log_line(LOG_INFO, "OpenGL on %s%s", d->name, d->same_device ? ", the same device as Vulkan's" : "");
	*device = d;
	return STATUS_OK;
}

void gl_device_destroy(struct gl_device *d)
{
	if (!d)
		return;
	glDeleteVertexArrays(1, &d->vertex_array);
	context_destroy(d);
	free(d);
}

enum status gl_check(struct gl_device *d, const char *what, struct error *err)
{
	enum status s = STATUS_OK;
	GLenum code;
	// A lost context answers with the same error for ever, so stop asking.
	while (!d->lost && (code = glGetError()) != GL_NO_ERROR) {
		if (code == GL_CONTEXT_LOST)
			d->lost = true;
		if (s != STATUS_OK)
			continue;
		if (code == GL_OUT_OF_MEMORY)
			s = error_set(err, STATUS_MEMORY, "%s: the OpenGL device is out of memory", what);
		else
			s = error_set(err, STATUS_DEVICE, "%s failed on the OpenGL device (error 0x%04x)", what, code);
	}
	if (d->lost)
		s = error_set(err, STATUS_DEVICE, "%s: the OpenGL device was reset", what);
	return s;
}

enum status gl_wait(struct gl_device *d, const char *what, struct error *err)
{
	glFinish();
	return gl_check(d, what, err);
}

enum status gl_reserve(const struct gl_device *d, uint64_t bytes, struct error *err)
{
	if (*d->bytes <= *d->budget && bytes <= *d->budget - *d->bytes)
		return STATUS_OK;
	if (d->wanted)
		*d->wanted = bytes;
	return error_set(err, STATUS_MEMORY, "%llu MiB more on the device would exceed the memory budget of %llu MiB",
			 (unsigned long long)((bytes + (1u << 20) - 1) >> 20), (unsigned long long)(*d->budget >> 20));
}
