// What a client may send behind a good header: the first byte is the message's type, the rest its body. fuzz_front seldom
// comes so far, for the length in a header has to fit what follows.
#include "tests/fuzz/decode.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	if (size > 0)
		decode_request(data[0], data + 1, size - 1);
	return 0;
}
