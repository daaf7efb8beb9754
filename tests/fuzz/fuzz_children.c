// What a loader or a worker that was taken over may send to the front, at any time and of any size, while loads, renders, a
// sweep and quotes are under way. Most messages begin as those of a child that works, and the input says which bytes of
// them are others, for a message of random bytes is refused at once. Whatever they send, each request has its one answer.
#include <fcntl.h>
#include <pb_encode.h>
#include <stddef.h>
#include <stdlib.h>
#include <unistd.h>

#include "protocol/header.h"
#include "tests/fuzz/stage_front.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct script {
	const uint8_t *at;
	size_t left;
	unsigned said; // requests that were sent
};

enum what { GOOD, ALTERED, CHOSEN, RAW, PASS, ENDS, ASK, WHATS };

static unsigned next(struct script *s)
{
	if (s->left == 0)
		return 0;
	s->left--;
	return *s->at++;
}

// Places that decide more than others do.
static const struct {
	uint32_t op; // 0: every
	size_t offset;
} places[] = {
    {0, offsetof(struct ipc_head, op)},
    {0, offsetof(struct ipc_head, job)},
    {IPC_READY, offsetof(struct ipc_ready, error)},
    {IPC_READY, offsetof(struct ipc_ready, others)},
    {IPC_READY, offsetof(struct ipc_ready, key)},
    {IPC_BEGUN, offsetof(struct ipc_begun, error)},
    {IPC_BEGUN, offsetof(struct ipc_begun, cold)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.plan_count)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.notes_count)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.warnings_count)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.technique)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.plan[0].has_share)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.plan[0].has_cost_us)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.default_light)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.device)},
    {IPC_BEGUN, offsetof(struct ipc_begun, accepted.samples)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, error)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, cold)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, samples_done)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, finished)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, reached)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, late)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, ready)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, scaled)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, fraction)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, estimate.relmse)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, estimate.kind)},
    {IPC_STEPPED, offsetof(struct ipc_stepped, device_us)},
    {IPC_IMAGE, offsetof(struct ipc_image, error)},
    {IPC_IMAGE, offsetof(struct ipc_image, frame.final)},
    {IPC_IMAGE, offsetof(struct ipc_image, frame.bytes)},
    {IPC_IMAGE, offsetof(struct ipc_image, frame.format)},
    {IPC_IMAGE, offsetof(struct ipc_image, done.stages_count)},
    {IPC_IMAGE, offsetof(struct ipc_image, done.figures_count)},
    {IPC_IMAGE, offsetof(struct ipc_image, done.notes_count)},
    {IPC_IMAGE, offsetof(struct ipc_image, done.samples)},
    {IPC_IMAGE, offsetof(struct ipc_image, done.has_verdict)},
    {IPC_IMAGE, offsetof(struct ipc_image, done.reason)},
    {IPC_IMAGE, offsetof(struct ipc_image, done.figures[0].value)},
    {IPC_PILOTED, offsetof(struct ipc_piloted, error)},
    {IPC_PILOTED, offsetof(struct ipc_piloted, cut)},
    {IPC_PILOTED, offsetof(struct ipc_piloted, results[0].pixels)},
    {IPC_PILOTED, offsetof(struct ipc_piloted, results[1].sample_us)},
    {IPC_PILOTED, offsetof(struct ipc_piloted, results[1].error.relmse)},
    {IPC_PILOTED, offsetof(struct ipc_piloted, results[2].error.kind)},
    {IPC_PILOTED, offsetof(struct ipc_piloted, results[2].bias[0].edges)},
    {IPC_LOADED, offsetof(struct ipc_loaded, build)},
    {IPC_LOADED, offsetof(struct ipc_loaded, error)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.hash)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.cameras_count)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.warnings_count)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.warnings[0])},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.ignored_count)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.facts_count)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.nodes_count)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.material_names_count)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.animations_count)},
    {IPC_LOADED, offsetof(struct ipc_loaded, info.environment_width)},
    {IPC_LOADED, offsetof(struct ipc_loaded, remarks)},
    {IPC_LOADED, offsetof(struct ipc_loaded, wants_images)},
};
#define PLACES (sizeof places / sizeof *places)

static void write_bytes(struct script *s, uint8_t *message, size_t bytes, size_t at)
{
	for (unsigned n = next(s) % 9; n > 0; n--)
		message[at++ % bytes] = (uint8_t)next(s);
}

static void alter_somewhere(struct script *s, uint8_t *message, size_t bytes)
{
	for (unsigned changes = next(s) % 4; changes > 0; changes--) {
		size_t at = next(s);
		at = 256 * at + next(s);
		write_bytes(s, message, bytes, at);
	}
}

static void alter_place(struct script *s, uint8_t *message, size_t bytes, uint32_t op)
{
	for (unsigned changes = next(s) % 4; changes > 0; changes--) {
		size_t found = next(s) % PLACES;
		// The next one that this message has.
		while (places[found].op != 0 && places[found].op != op)
			found = (found + 1) % PLACES;
		write_bytes(s, message, bytes, places[found].offset);
	}
}

// A descriptor of some kind, to be closed unless it is the stage's.
static int descriptor(unsigned kind)
{
	switch (kind % 4) {
	case 0:
		return stage_sealed();
	case 1:
		return -1;
	case 2:
		return open("/dev/null", O_RDWR | O_CLOEXEC);
	default:
		return open("/", O_PATH | O_DIRECTORY | O_CLOEXEC);
	}
}

static void say(struct puppet *p, const void *message, size_t bytes, unsigned kind)
{
	const int fd = descriptor(kind);
	stage_say(p, message, bytes, fd);
	if (fd >= 0 && fd != stage_sealed())
		close(fd);
}

static void say_altered(struct script *s, struct puppet *p, enum what what, unsigned kind)
{
	static union stage_message m;
	// Mostly the answer that is due, else any.
	const unsigned chosen = next(s);
	const uint32_t op = chosen < 16 ? IPC_READY + chosen % (IPC_LOADED - IPC_READY + 1) : 0;
	const size_t bytes = stage_answer(p, op, &m);
	if (bytes == 0)
		return;
	if (what == ALTERED)
		alter_somewhere(s, m.bytes, bytes);
	else
		alter_place(s, m.bytes, bytes, m.head.op);
	say(p, &m, bytes, kind);
}

static void say_raw(struct script *s, struct puppet *p, unsigned kind)
{
	static uint8_t bytes[IPC_MAX_BYTES];
	size_t size = 0;
	for (unsigned n = next(s); n > 0 && size < sizeof bytes; n--)
		bytes[size++] = (uint8_t)next(s);
	if (size > 0)
		say(p, bytes, size, kind);
}

static void ask(uint8_t type, uint32_t request, const pb_msgdesc_t *fields, const void *body)
{
	static uint8_t message[CANDIL_HEADER_BYTES + LIMIT_MESSAGE_BYTES];
	pb_ostream_t out = pb_ostream_from_buffer(message + CANDIL_HEADER_BYTES, LIMIT_MESSAGE_BYTES);
	struct header h = {.version = CANDIL_VERSION, .type = type, .request = request};
	if (!pb_encode(&out, fields, body))
		return;
	h.length = (uint32_t)out.bytes_written;
	header_encode(&h, message);
	stage_send(0, message, CANDIL_HEADER_BYTES + out.bytes_written, false);
}

static candil_Render plain_render(void)
{
	candil_Render render = {.scene = "box",
				.technique = candil_Technique_TECHNIQUE_PT,
				.width = 64,
				.height = 64,
				.samples = 4,
				.progressive = true,
				.has_camera = true};
	render.camera = (candil_Camera){.has_eye = true, .has_target = true, .has_up = true, .vfov_degrees = 40};
	render.camera.eye.z = 3;
	render.camera.up.y = 1;
	return render;
}

// One more request, of each kind in turn.
static void ask_more(struct script *s)
{
	static candil_Sweep sweep;
	const uint32_t request = ++s->said + 1;
	const candil_Load load = {.name = "box", .path = "box.gltf"};
	candil_Render render = plain_render();
	candil_Quote quote = {.has_render = true, .render = render};
	const candil_Hello hello = {.version_min = CANDIL_VERSION, .version_max = CANDIL_VERSION};
	const candil_Stats stats = {0};
	switch (s->said % 6) {
	case 1:
		if (s->said == 1)
			ask(MESSAGE_HELLO, 1, candil_Hello_fields, &hello);
		ask(MESSAGE_LOAD, request, candil_Load_fields, &load);
		break;
	case 2:
		ask(MESSAGE_RENDER, request, candil_Render_fields, &render);
		break;
	case 3:
		ask(MESSAGE_QUOTE, request, candil_Quote_fields, &quote);
		break;
	case 4:
		render.technique = candil_Technique_TECHNIQUE_AUTO;
		render.target_error = 0.01;
		ask(MESSAGE_RENDER, request, candil_Render_fields, &render);
		break;
	case 5:
		sweep = (candil_Sweep){.has_render = true, .render = render, .cameras_count = 3};
		sweep.render.has_camera = false;
		for (unsigned i = 0; i < sweep.cameras_count; i++)
			sweep.cameras[i] = render.camera;
		ask(MESSAGE_SWEEP, request, candil_Sweep_fields, &sweep);
		break;
	default:
		ask(MESSAGE_STATS, request, candil_Stats_fields, &stats);
	}
}

static bool act(void *owner)
{
	static const int signals[] = {0, 6, 9, 11};
	struct script *s = owner;
	if (s->left == 0)
		return false;
	const unsigned byte = next(s), n = byte / WHATS;
	const enum what what = byte % WHATS;
	struct puppet *p = stage_puppet(n % 8 == 7 ? STAGE_COMPILER : n % 4 == 3 ? STAGE_LOADER : STAGE_WORKER);
	if (!p)
		p = stage_puppet(STAGE_LOADER);
	if (what == ASK) {
		ask_more(s);
	} else if (what == PASS || !p) {
		stage_pass();
	} else if (what == GOOD) {
		for (unsigned i = 0; i <= n && stage_work(p); i++)
			continue;
	} else if (what == ENDS) {
		stage_end(p, signals[n % 4]);
	} else if (what == RAW) {
		say_raw(s, p, n / 4);
	} else {
		say_altered(s, p, what, n / 4);
	}
	return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct script script = {.at = data, .left = size};
	stage_run(act, &script);
	for (uint32_t request = 1; script.said > 0 && request <= script.said + 1; request++)
		if (stage_ends(0, request) != 1)
			abort();
	return 0;
}
