// Decodes the body of any message that a client may send, as the front does.
#ifndef CANDIL_TESTS_DECODE_H
#define CANDIL_TESTS_DECODE_H

#include <stddef.h>
#include <stdint.h>

// `type`: enum message_type; nothing is done for one that no client sends.
void decode_request(uint8_t type, const uint8_t *body, size_t bytes);

#endif
