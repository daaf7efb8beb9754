// What a client may send: a stream of bytes into the front's reader, each complete message into its decoder.
#include <stdint.h>
#include <string.h>

#include "server/front/reader.h"
#include "server/front/request.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void decode(const struct reader *r)
{
	static union {
		candil_Hello hello;
		candil_Load load;
		candil_Unload unload;
		candil_Describe describe;
		candil_Render render;
		candil_Sweep sweep;
		candil_Quote quote;
		candil_Cancel cancel;
		candil_Ping ping;
		candil_ListScenes list;
		candil_Stats stats;
	} m;
	struct error err;
	const uint8_t *b = r->body;
	const size_t n = r->header.length;
	switch (r->header.type) {
	case MESSAGE_HELLO:
		request_hello(b, n, &m.hello, &err);
		break;
	case MESSAGE_LOAD:
		request_load(b, n, &m.load, &err);
		break;
	case MESSAGE_UNLOAD:
		request_unload(b, n, &m.unload, &err);
		break;
	case MESSAGE_DESCRIBE:
		request_describe(b, n, &m.describe, &err);
		break;
	case MESSAGE_RENDER:
		request_render(b, n, &m.render, &err);
		break;
	case MESSAGE_SWEEP:
		request_sweep(b, n, &m.sweep, &err);
		break;
	case MESSAGE_QUOTE:
		request_quote(b, n, &m.quote, &err);
		break;
	case MESSAGE_CANCEL:
		request_decode(b, n, candil_Cancel_fields, &m.cancel, &err);
		break;
	case MESSAGE_PING:
		request_decode(b, n, candil_Ping_fields, &m.ping, &err);
		break;
	case MESSAGE_LIST_SCENES:
		request_decode(b, n, candil_ListScenes_fields, &m.list, &err);
		break;
	case MESSAGE_STATS:
		request_decode(b, n, candil_Stats_fields, &m.stats, &err);
		break;
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct reader r;
	reader_init(&r);
	while (size > 0) {
		size_t room;
		bool complete;
		uint8_t *at = reader_space(&r, &room);
		const size_t n = size < room ? size : room;
		memcpy(at, data, n);
		data += n;
		size -= n;
		if (reader_take(&r, n, &complete) != STATUS_OK)
			break;
		if (complete) {
			decode(&r);
			reader_next(&r);
		}
	}
	reader_finish(&r);
	return 0;
}
