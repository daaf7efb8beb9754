#include "server/worker/gl/program.h"

#include <epoxy/gl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/names.h"
#include "server/base/log.h"
#include "server/worker/code_list.h"

static const char version[] = "#version 450 core\n";

void gl_define(struct gl_defines *d, const char *name, const char *format, ...)
{
	char value[64];
	va_list args;
	va_start(args, format);
	vsnprintf(value, sizeof value, format, args);
	va_end(args);
	const size_t used = strlen(d->text);
	const int n = snprintf(d->text + used, sizeof d->text - used, "#define %s %s\n", name, value);
	d->full = d->full || n < 0 || (size_t)n >= sizeof d->text - used;
}

void gl_define_effects(struct gl_defines *d, uint32_t effects)
{
#define DEFINE_EFFECT(NAME, number, ...) gl_define(d, "EFFECT_" #NAME, "%s", effects >> (number)&1u ? "true" : "false");
	CANDIL_EFFECT_LIST(DEFINE_EFFECT)
#undef DEFINE_EFFECT
}

static enum status gl_program_compile(GLenum stage, const struct gl_program *p, const char *text, GLuint *shader,
				      struct error *err)
{
	const char *const parts[] = {version, p->defines, text};
	*shader = glCreateShader(stage);
	glShaderSource(*shader, 3, parts, NULL);
	glCompileShader(*shader);
	GLint ok = GL_FALSE;
	glGetShaderiv(*shader, GL_COMPILE_STATUS, &ok);
	if (ok)
		return STATUS_OK;
	char words[1024] = "";
	glGetShaderInfoLog(*shader, sizeof words, NULL, words);
	log_line(LOG_ERROR, "%s: %s", p->source->name, words);
	return error_set(err, STATUS_INTERNAL, "the shader %s does not compile: %.180s", p->source->name, words);
}

static enum status link_program(struct gl_program *p, struct error *err)
{
	GLint ok = GL_FALSE;
	glLinkProgram(p->name);
	glGetProgramiv(p->name, GL_LINK_STATUS, &ok);
	if (ok)
		return STATUS_OK;
	char words[1024] = "";
	glGetProgramInfoLog(p->name, sizeof words, NULL, words);
	log_line(LOG_ERROR, "%s: %s", p->source->name, words);
	return error_set(err, STATUS_INTERNAL, "the shader %s does not link: %.180s", p->source->name, words);
}

static enum status build(struct gl_program *p, struct error *err)
{
	const struct {
		GLenum stage;
		const char *text;
	} stages[] = {{GL_COMPUTE_SHADER, p->source->compute},
		      {GL_VERTEX_SHADER, p->source->vertex},
		      {GL_FRAGMENT_SHADER, p->source->fragment}};
	enum status s = STATUS_OK;
	p->name = glCreateProgram();
	for (unsigned i = 0; s == STATUS_OK && i < sizeof stages / sizeof *stages; i++) {
		if (!stages[i].text)
			continue;
		GLuint shader;
		s = gl_program_compile(stages[i].stage, p, stages[i].text, &shader, err);
		if (s == STATUS_OK)
			glAttachShader(p->name, shader);
		// The shader lives on for as long as it is attached.
		glDeleteShader(shader);
	}
	return s == STATUS_OK ? link_program(p, err) : s;
}

void gl_program_use(struct gl_device *d, const struct gl_program *p)
{
	glUseProgram(p->name);
	d->shapes = 0;
}

// FNV-1a's step, by words.
void gl_shape(struct gl_device *d, uint64_t shape)
{
	d->shapes = (d->shapes ^ shape) * 0x100000001b3ull + 1;
}

bool gl_program_is_warm(const struct gl_device *d, const struct gl_program *p)
{
	const uint32_t kept = p->warm_count < GL_PROGRAM_SHAPES ? p->warm_count : GL_PROGRAM_SHAPES;
	if (!d->software)
		return kept > 0;
	for (uint32_t i = 0; i < kept; i++)
		if (p->warm[i] == d->shapes)
			return true;
	return false;
}

// The piece of code that the program in use is with the textures that are bound.
static uint64_t piece_in_use(const struct gl_device *d, const struct gl_program *p)
{
	return d->software ? code_piece(p->piece, &d->shapes, sizeof d->shapes) : p->piece;
}

enum status gl_program_ask(const struct gl_device *d, const struct gl_program *p, bool *warm, struct error *err)
{
	*warm = gl_program_is_warm(d, p);
	return *warm || !d->code ? STATUS_OK : code_list_ask(d->code, piece_in_use(d, p), err);
}

void gl_program_has_run(const struct gl_device *d, struct gl_program *p)
{
	if (gl_program_is_warm(d, p))
		return;
	p->warm[p->warm_count++ % GL_PROGRAM_SHAPES] = d->shapes;
	if (d->code)
		code_list_add(d->code, piece_in_use(d, p));
}

void gl_program_hold(struct gl_program *p)
{
	if (p)
		p->users++;
}

void gl_program_release(struct gl_program *p)
{
	if (p)
		p->users--;
}

// Destroy the program unused for longest if there is no room for one more.
static void gl_program_trim(struct gl_device *d)
{
	struct gl_program **oldest = NULL;
	unsigned count = 0;
	for (struct gl_program **at = &d->programs; *at; at = &(*at)->next) {
		count++;
		if ((*at)->users == 0 && (!oldest || (*at)->used < (*oldest)->used))
			oldest = at;
	}
	if (count < GL_PROGRAMS_MAX || !oldest)
		return;
	struct gl_program *p = *oldest;
	*oldest = p->next;
	glDeleteProgram(p->name);
	free(p);
}

static uint64_t piece_of(const struct gl_source *source, const struct gl_defines *defines)
{
	const char *const parts[] = {source->compute, source->vertex, source->fragment, defines->text};
	uint64_t piece = 0;
	for (unsigned i = 0; i < sizeof parts / sizeof *parts; i++)
		if (parts[i])
			piece = code_piece(piece, parts[i], strlen(parts[i]));
	return piece;
}

enum status gl_program_get(struct gl_device *d, const struct gl_source *source, const struct gl_defines *defines,
			   struct gl_program **program, struct error *err)
{
	for (struct gl_program *p = d->programs; p; p = p->next)
		if (p->source == source && !strcmp(p->defines, defines->text)) {
			p->used = ++d->program_turn;
			*program = p;
			return STATUS_OK;
		}
	if (defines->full)
		return error_set(err, STATUS_INTERNAL, "too many macros for the shader %s", source->name);
	const uint64_t piece = piece_of(source, defines);
	enum status s = d->code ? code_list_ask(d->code, piece, err) : STATUS_OK;
	if (s != STATUS_OK)
		return s;
	struct gl_program *p = calloc(1, sizeof *p);
	if (!p)
		return error_set(err, STATUS_MEMORY, "out of memory");
	p->source = source;
	p->piece = piece;
	memcpy(p->defines, defines->text, sizeof p->defines);
	s = build(p, err);
	if (s == STATUS_OK)
		s = gl_check(d, "making a program", err);
	if (s != STATUS_OK) {
		glDeleteProgram(p->name);
		free(p);
		return s;
	}
	if (d->code)
		code_list_add(d->code, piece);
	gl_program_trim(d);
	p->used = ++d->program_turn;
	p->next = d->programs;
	d->programs = p;
	*program = p;
	return STATUS_OK;
}

void gl_program_destroy_all(struct gl_device *d)
{
	while (d->programs) {
		struct gl_program *p = d->programs;
		d->programs = p->next;
		glDeleteProgram(p->name);
		free(p);
	}
}
