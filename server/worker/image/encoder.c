// Two threads meet here. The device's thread hands over frames in encoder_submit and never touches them again; the
// encoder's thread owns a frame from the moment it takes it out of the ring until it is destroyed. The ring, its two
// counters, `wanted` and `stopping` are guarded by `mutex`; `socket`, `device` and `open` do not change after
// encoder_create; `encode` and `opened_us` are the encoder's thread's alone. Encoding and sending happen outside the lock,
// so submitting waits only when the ring is full. A front that has gone away makes sending fail: the frame is dropped with a
// line in the log, and the worker's own loop, which reads the same socket, ends the process.
#include "server/worker/image/encoder.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/base/clock.h"
#include "server/base/ipc.h"
#include "server/base/log.h"

struct encoder {
	int socket;
	char device[sizeof((candil_Done *)0)->device];
	pthread_t thread;
	pthread_mutex_t mutex;
	pthread_cond_t changed; // the ring has changed, or the thread is to stop
	struct encoder_task ring[ENCODER_QUEUE_FRAMES];
	uint32_t first, count;
	bool wanted; // the codec, for a frame will come
	uint64_t opened_us; // clock_us() when it was open
	bool stopping;
	codec_function *(*open)(struct error *err);
	codec_function *encode; // NULL: not open
};

static void fill_figures(const struct frame *f, candil_Done *done)
{
	_Static_assert(sizeof done->figures / sizeof done->figures[0] == FRAME_FIGURES_MAX, "each has a place");
	for (uint32_t i = 0; i < f->figure_count; i++) {
		candil_Figure *figure = &done->figures[done->figures_count++];
		snprintf(figure->name, sizeof figure->name, "%s", f->figures[i].name);
		snprintf(figure->unit, sizeof figure->unit, "%s", f->figures[i].unit);
		figure->value = f->figures[i].value;
	}
}

static void fill_image(const struct encoder *e, const struct encoder_task *task, size_t bytes, struct ipc_image *image)
{
	const struct frame *f = task->frame;
	image->frame.index = 0;
	image->frame.final = task->final;
	image->frame.format = (candil_Format)task->file.format;
	image->frame.width = f->width;
	image->frame.height = f->height;
	image->frame.made_width = f->made_width;
	image->frame.made_height = f->made_height;
	image->frame.samples = f->samples;
	image->frame.bytes = bytes;

	candil_Done *done = &image->done;
	const size_t capacity = sizeof done->stages / sizeof done->stages[0];
	done->samples = f->samples;
	for (uint32_t i = 0; i < f->stage_count && i < capacity; i++) {
		candil_Stage *stage = &done->stages[done->stages_count++];
		snprintf(stage->name, sizeof stage->name, "%s", f->stages[i].name);
		stage->us = f->stages[i].us;
	}
	fill_figures(f, done);
	_Static_assert(sizeof done->notes == sizeof f->notes, "frame.h and candil.options differ");
	done->notes_count = (pb_size_t)f->note_count;
	memcpy(done->notes, f->notes, sizeof done->notes);
	done->estimated_relmse = f->estimate.relmse;
	done->relmse_low = f->estimate.low;
	done->relmse_high = f->estimate.high;
	done->error_kind = f->estimate.kind;
	done->cold_us = f->cold_us;
	done->non_finite_samples = f->non_finite_samples;
	done->rays = f->rays;
	memcpy(done->device, e->device, sizeof done->device);
	image->work = f->work;
}

// Judge a final frame, for the reply and for the last of its notes.
static void judge(const struct encoder_task *task, struct ipc_image *image)
{
	char note[sizeof task->frame->notes[0]];
	if (!task->final)
		return;
	const candil_Verdict verdict = verdict_of(task->frame, &task->file, &task->about, note, sizeof note);
	if (note[0])
		frame_add_note(task->frame, "%s", note);
	image->frame.has_verdict = image->done.has_verdict = true;
	image->frame.verdict = image->done.verdict = verdict;
}

static void send_image(int socket, const struct ipc_image *image, int fd)
{
	struct error err;
	for (;;) {
		if (ipc_send_patiently(socket, image, sizeof *image, fd, &err) == STATUS_OK)
			return;
		if (errno != EAGAIN)
			break;
		// The socket may be non-blocking for the device's thread, which must not wait. This thread may.
		struct pollfd p = {.fd = socket, .events = POLLOUT};
		if (poll(&p, 1, -1) < 0 && errno != EINTR)
			break;
	}
	log_line(LOG_WARNING, "image of job %u dropped: %s", image->head.job, err.text);
}

static void work(struct encoder *e, const struct encoder_task *task)
{
	struct ipc_image image;
	memset(&image, 0, sizeof image); // with the padding, which is sent too
	image.head.op = IPC_IMAGE;
	image.head.job = task->job;
	const bool is_file = task->frame->file >= 0;
	int fd = is_file ? task->frame->file : -1;
	size_t bytes = is_file ? task->frame->file_bytes : 0;
	if (!e->encode && !is_file) {
		e->encode = e->open(&image.error);
		e->opened_us = clock_us();
	}
	const uint64_t start = clock_us();
	// Until the codec was open, all that waited did so for it.
	const uint64_t ready = e->opened_us > task->submitted_us ? e->opened_us : task->submitted_us;
	if (ready > task->submitted_us)
		frame_add_stage(task->frame, FRAME_STAGE_OPEN, ready - task->submitted_us);
	frame_add_stage(task->frame, "encoder", start - ready);
	const struct verdict_file *file = &task->file;
	if (e->encode && !is_file)
		image.error.code =
		    e->encode(task->frame, file->format, file->view, file->exposure_ev, &fd, &bytes, &image.error);
	if (!is_file)
		judge(task, &image);
	frame_add_stage(task->frame, "encode", clock_us() - start);
	fill_image(e, task, bytes, &image);
	send_image(e->socket, &image, fd);
	if (fd >= 0 && !is_file)
		close(fd);
}

static void open_early(struct encoder *e)
{
	struct error ignored; // if it is still so, the frame's own attempt tells
	pthread_mutex_unlock(&e->mutex);
	e->encode = e->open(&ignored);
	if (!e->encode)
		log_line(LOG_WARNING, "the codec cannot be linked: %s", ignored.text);
	e->opened_us = clock_us();
	pthread_mutex_lock(&e->mutex);
}

// Wait for the next task. False: the thread is to stop, and nothing is queued.
static bool encoder_take(struct encoder *e, struct encoder_task *task)
{
	pthread_mutex_lock(&e->mutex);
	while (e->count == 0 && !e->stopping) {
		const bool early = e->wanted && !e->encode;
		e->wanted = false;
		if (early)
			open_early(e);
		else
			pthread_cond_wait(&e->changed, &e->mutex);
	}
	bool got = e->count > 0;
	if (got) {
		*task = e->ring[e->first];
		e->first = (e->first + 1) % ENCODER_QUEUE_FRAMES;
		e->count--;
		pthread_cond_broadcast(&e->changed);
	}
	pthread_mutex_unlock(&e->mutex);
	return got;
}

static void *encoder_run(void *argument)
{
	struct encoder *e = argument;
	struct encoder_task task;
	while (encoder_take(e, &task)) {
		work(e, &task);
		frame_destroy(task.frame);
	}
	return NULL;
}

enum status encoder_create(int socket, const char *device, codec_function *(*open)(struct error *err),
			   struct encoder **encoder, struct error *err)
{
	struct encoder *e = calloc(1, sizeof *e);
	if (!e)
		return error_set(err, STATUS_MEMORY, "no memory for the encoder");
	e->socket = socket;
	e->open = open;
	snprintf(e->device, sizeof e->device, "%s", device);
	pthread_mutex_init(&e->mutex, NULL);
	pthread_cond_init(&e->changed, NULL);

	// Signals are for the main thread.
	sigset_t all, before;
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	int failed = pthread_create(&e->thread, NULL, encoder_run, e);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (failed) {
		pthread_cond_destroy(&e->changed);
		pthread_mutex_destroy(&e->mutex);
		free(e);
		return error_set(err, STATUS_INTERNAL, "cannot start the encoder's thread: %s", strerror(failed));
	}
	*encoder = e;
	return STATUS_OK;
}

void encoder_prepare(struct encoder *encoder)
{
	pthread_mutex_lock(&encoder->mutex);
	encoder->wanted = true;
	pthread_cond_broadcast(&encoder->changed);
	pthread_mutex_unlock(&encoder->mutex);
}

void encoder_submit(struct encoder *encoder, const struct encoder_task *task)
{
	const uint64_t submitted_us = clock_us();
	pthread_mutex_lock(&encoder->mutex);
	while (encoder->count == ENCODER_QUEUE_FRAMES)
		pthread_cond_wait(&encoder->changed, &encoder->mutex);
	struct encoder_task *slot = &encoder->ring[(encoder->first + encoder->count) % ENCODER_QUEUE_FRAMES];
	*slot = *task;
	slot->submitted_us = submitted_us;
	encoder->count++;
	pthread_cond_broadcast(&encoder->changed);
	pthread_mutex_unlock(&encoder->mutex);
}

void encoder_destroy(struct encoder *encoder)
{
	if (!encoder)
		return;
	pthread_mutex_lock(&encoder->mutex);
	encoder->stopping = true;
	pthread_cond_broadcast(&encoder->changed);
	pthread_mutex_unlock(&encoder->mutex);
	pthread_join(encoder->thread, NULL);
	pthread_cond_destroy(&encoder->changed);
	pthread_mutex_destroy(&encoder->mutex);
	free(encoder);
}
