// What a client may send: a stream of bytes into the front's reader, each complete message into its decoder.
#include <stdint.h>
#include <string.h>

#include "server/front/reader.h"
#include "tests/fuzz/decode.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

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
			decode_request(r.header.type, r.body, r.header.length);
			reader_next(&r);
		}
	}
	reader_finish(&r);
	return 0;
}
