#include "tests/fuzz/decode.h"

#include "protocol/header.h"
#include "server/front/request.h"

void decode_request(uint8_t type, const uint8_t *body, size_t bytes)
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
	switch (type) {
	case MESSAGE_HELLO:
		request_hello(body, bytes, &m.hello, &err);
		break;
	case MESSAGE_LOAD:
		request_load(body, bytes, &m.load, &err);
		break;
	case MESSAGE_UNLOAD:
		request_unload(body, bytes, &m.unload, &err);
		break;
	case MESSAGE_DESCRIBE:
		request_describe(body, bytes, &m.describe, &err);
		break;
	case MESSAGE_RENDER:
		request_render(body, bytes, &m.render, &err);
		break;
	case MESSAGE_SWEEP:
		request_sweep(body, bytes, &m.sweep, &err);
		break;
	case MESSAGE_QUOTE:
		request_quote(body, bytes, &m.quote, &err);
		break;
	case MESSAGE_CANCEL:
		request_decode(body, bytes, candil_Cancel_fields, &m.cancel, &err);
		break;
	case MESSAGE_PING:
		request_decode(body, bytes, candil_Ping_fields, &m.ping, &err);
		break;
	case MESSAGE_LIST_SCENES:
		request_decode(body, bytes, candil_ListScenes_fields, &m.list, &err);
		break;
	case MESSAGE_STATS:
		request_decode(body, bytes, candil_Stats_fields, &m.stats, &err);
		break;
	}
}
