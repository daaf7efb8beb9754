#include "server/front/reader.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

void reader_init(struct reader *reader)
{
	memset(reader, 0, sizeof *reader);
	reader->fd = -1;
}

void reader_finish(struct reader *reader)
{
	reader_next(reader);
}

uint8_t *reader_space(struct reader *reader, size_t *bytes)
{
	if (reader->in_body) {
		*bytes = reader->header.length - reader->have;
		return reader->body + reader->have;
	}
	*bytes = sizeof reader->head - reader->have;
	return reader->head + reader->have;
}

void reader_take_fd(struct reader *reader, int fd)
{
	if (reader->in_body || reader->fd >= 0)
		close(fd);
	else
		reader->fd = fd;
}

static enum status begin_body(struct reader *reader, bool *complete)
{
	enum status status = header_decode(reader->head, &reader->header);
	if (status != STATUS_OK)
		return status;
	reader->in_body = true;
	reader->have = 0;
	*complete = reader->header.length == 0;
	if (*complete)
		return STATUS_OK;
	reader->body = malloc(reader->header.length);
	return reader->body ? STATUS_OK : STATUS_MEMORY;
}

enum status reader_take(struct reader *reader, size_t bytes, bool *complete)
{
	*complete = false;
	reader->have += bytes;
	if (reader->in_body)
		*complete = reader->have == reader->header.length;
	else if (reader->have == sizeof reader->head)
		return begin_body(reader, complete);
	return STATUS_OK;
}

int reader_claim_fd(struct reader *reader)
{
	int fd = reader->fd;
	reader->fd = -1;
	return fd;
}

void reader_next(struct reader *reader)
{
	free(reader->body);
	if (reader->fd >= 0)
		close(reader->fd);
	reader_init(reader);
}
