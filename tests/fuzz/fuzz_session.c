// What clients may do, over time: three of them connect, send messages whole, torn and with descriptors, read or do not, and
// go, while loaders and workers do what they are told, end, or hang. Each byte of the input says what happens next. No
// request is answered twice.
#include <stdlib.h>
#include <string.h>

#include "protocol/header.h"
#include "tests/fuzz/stage_front.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

struct script {
	const uint8_t *at;
	size_t left;
	unsigned short asked[STAGE_CLIENTS][256]; // messages by their id
	bool torn[STAGE_CLIENTS]; // it has sent bytes that need be no messages
};

enum what { MESSAGE, BYTES, WORK, PASS, LOADER_ENDS, WORKER_ENDS, READS, HANG_UP, WHATS };

static unsigned next(struct script *s)
{
	if (s->left == 0)
		return 0;
	s->left--;
	return *s->at++;
}

static const uint8_t *piece(struct script *s, size_t *bytes)
{
	const uint8_t *at = s->at;
	*bytes = *bytes < s->left ? *bytes : s->left;
	s->at += *bytes;
	s->left -= *bytes;
	return at;
}

// The length of a body is two bytes, of which the first counts 256, so that short ones are written 0, n.
static void send_message(struct script *s, unsigned client)
{
	static uint8_t message[CANDIL_HEADER_BYTES + LIMIT_MESSAGE_BYTES];
	struct header h = {.version = CANDIL_VERSION};
	h.type = (uint8_t)next(s);
	const unsigned flags = next(s);
	h.flags = flags & HEADER_FLAG_FD;
	h.request = next(s);
	size_t bytes = 256u * next(s);
	bytes += next(s);
	const uint8_t *body = piece(s, &bytes);
	h.length = (uint32_t)bytes;
	header_encode(&h, message);
	memcpy(message + CANDIL_HEADER_BYTES, body, bytes);
	stage_send(client, message, CANDIL_HEADER_BYTES + bytes, flags & 2u);
	s->asked[client % STAGE_CLIENTS][h.request]++;
}

static void work(unsigned orders)
{
	for (enum stage_role role = STAGE_LOADER; role <= STAGE_COMPILER; role++)
		for (unsigned i = 0; i < orders && stage_work(stage_puppet(role)); i++)
			continue;
}

static bool act(void *owner)
{
	static const int signals[] = {0, 6, 9, 11};
	struct script *s = owner;
	size_t bytes;
	if (s->left == 0)
		return false;
	const unsigned what = next(s), n = what / WHATS;
	switch ((enum what)(what % WHATS)) {
	case MESSAGE:
		send_message(s, n);
		break;
	case BYTES:
		bytes = next(s);
		const uint8_t *torn = piece(s, &bytes);
		stage_send(n, torn, bytes, false);
		s->torn[n % STAGE_CLIENTS] = true;
		break;
	case WORK:
		work(n + 1);
		break;
	case PASS:
		stage_pass();
		break;
	case LOADER_ENDS:
		stage_end(stage_puppet(STAGE_LOADER), signals[n % 4]);
		break;
	case WORKER_ENDS:
		stage_end(stage_puppet(STAGE_WORKER), signals[n % 4]);
		break;
	case READS:
		stage_reads(n, n / STAGE_CLIENTS % 2 == 0);
		break;
	default:
		stage_hang_up(n);
	}
	return true;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct script script = {.at = data, .left = size};
	stage_run(act, &script);
	for (unsigned c = 0; c < STAGE_CLIENTS; c++)
		for (uint32_t request = 1; request < 256 && !script.torn[c]; request++)
			if (stage_ends(c, request) > script.asked[c][request])
				abort();
	return 0;
}
