#include "server/worker/gl/timer.h"

#include <epoxy/gl.h>
#include <string.h>

void gl_timer_init(struct gl_timer *t)
{
	memset(t, 0, sizeof *t);
	glCreateQueries(GL_TIMESTAMP, 2 * GL_TIMER_PENDING, t->queries);
}

void gl_timer_finish(struct gl_timer *t)
{
	if (t->queries[0])
		glDeleteQueries(2 * GL_TIMER_PENDING, t->queries);
	memset(t, 0, sizeof *t);
}

static uint32_t stage_of(struct gl_timer *t, const char *name)
{
	uint32_t i = 0;
	while (i < t->stage_count && strcmp(t->stages[i].name, name) != 0)
		i++;
	if (i == t->stage_count && i < GL_TIMER_STAGES)
		t->stages[t->stage_count++] = (struct gl_stage){.name = name};
	return i;
}

void gl_timer_begin(struct gl_timer *t, const char *stage)
{
	if (t->pending_count == GL_TIMER_PENDING)
		gl_timer_collect(t);
	const uint32_t i = t->pending_count;
	t->pending[i].stage = stage_of(t, stage);
	t->pending[i].from = t->queries[2 * i];
	t->pending[i].to = t->queries[2 * i + 1];
	glQueryCounter(t->pending[i].from, GL_TIMESTAMP);
}

void gl_timer_end(struct gl_timer *t)
{
	glQueryCounter(t->pending[t->pending_count++].to, GL_TIMESTAMP);
}

void gl_timer_add(struct gl_timer *t, const char *stage, uint64_t us)
{
	const uint32_t i = stage_of(t, stage);
	if (i < GL_TIMER_STAGES)
		t->stages[i].us += us;
}

void gl_timer_collect(struct gl_timer *t)
{
	for (uint32_t i = 0; i < t->pending_count; i++) {
		GLuint64 from = 0, to = 0;
		glGetQueryObjectui64v(t->pending[i].from, GL_QUERY_RESULT, &from);
		glGetQueryObjectui64v(t->pending[i].to, GL_QUERY_RESULT, &to);
		if (t->pending[i].stage >= GL_TIMER_STAGES)
			continue;
		struct gl_stage *s = &t->stages[t->pending[i].stage];
		s->us += to > from ? (to - from) / 1000 : 0;
		s->passes++;
	}
	t->pending_count = 0;
}
