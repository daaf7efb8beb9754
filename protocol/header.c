#include "protocol/header.h"

#include "protocol/limits.h"

#define X(name, number, ...) _Static_assert((number) < 0x80, "a request's number");
CANDIL_REQUEST_LIST(X)
#undef X
#define X(name, number) _Static_assert((number) >= 0x80, "a reply's number");
CANDIL_REPLY_LIST(X)
#undef X

static const uint16_t known_flags = HEADER_FLAG_FD;

static void put32(uint8_t *out, uint32_t v)
{
	out[0] = (uint8_t)v;
	out[1] = (uint8_t)(v >> 8);
	out[2] = (uint8_t)(v >> 16);
	out[3] = (uint8_t)(v >> 24);
}

static uint32_t get32(const uint8_t *in)
{
	return (uint32_t)in[0] | (uint32_t)in[1] << 8 | (uint32_t)in[2] << 16 | (uint32_t)in[3] << 24;
}

void header_encode(const struct header *h, uint8_t out[CANDIL_HEADER_BYTES])
{
	put32(out, CANDIL_MAGIC);
	out[4] = h->version;
	out[5] = h->type;
	out[6] = (uint8_t)h->flags;
	out[7] = (uint8_t)(h->flags >> 8);
	put32(out + 8, h->length);
	put32(out + 12, h->request);
}

enum status header_decode(const uint8_t in[CANDIL_HEADER_BYTES], struct header *out)
{
	if (get32(in) != CANDIL_MAGIC)
		return STATUS_BAD_MAGIC;
	out->version = in[4];
	out->type = in[5];
	out->flags = (uint16_t)(in[6] | in[7] << 8);
	out->length = get32(in + 8);
	out->request = get32(in + 12);
	if (out->version != CANDIL_VERSION)
		return STATUS_BAD_VERSION;
	if (out->flags & ~known_flags)
		return STATUS_BAD_FLAGS;
	if (out->length > LIMIT_MESSAGE_BYTES)
		return STATUS_MESSAGE_TOO_LONG;
	return STATUS_OK;
}

const char *message_type_name(uint8_t type)
{
	switch (type) {
#define X(name, number, ...) \
	case number: \
		return #name;
		CANDIL_REQUEST_LIST(X)
		CANDIL_REPLY_LIST(X)
#undef X
	}
	return "unknown";
}

uint8_t message_last_reply(uint8_t request)
{
	switch (request) {
#define X(name, number, reply) \
	case number: \
		return MESSAGE_##reply;
		CANDIL_REQUEST_LIST(X)
#undef X
	}
	return 0;
}

bool message_is_reply(uint8_t type)
{
	switch (type) {
#define X(name, number) case number:
		CANDIL_REPLY_LIST(X)
#undef X
		return true;
	}
	return false;
}
