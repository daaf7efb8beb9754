#include "server/front/jobs/room.h"

#include "protocol/limits.h"

// No sum of these passes 2^64: an image has at most LIMIT_PIXELS, and a job has two images.
uint64_t room_bytes(const struct room *room)
{
	return room->own + room->common;
}

static enum room_kind room_choose(const struct room *all, const struct room *connection, uint64_t bytes, bool own_only)
{
	if (connection->own + bytes <= LIMIT_OWN_IMAGE_BYTES)
		return ROOM_OWN;
	if (!own_only && (all->common == 0 || all->common + bytes <= LIMIT_COMMON_IMAGE_BYTES))
		return ROOM_COMMON;
	return ROOM_NONE;
}

static void room_put(struct room *all, struct room *connection, const struct room_place *place)
{
	if (place->kind == ROOM_OWN) {
		all->own += place->bytes;
		connection->own += place->bytes;
	} else if (place->kind == ROOM_COMMON) {
		all->common += place->bytes;
		connection->common += place->bytes;
	}
}

enum room_answer room_take(struct room *all, struct room *connection, struct room_place *place, uint64_t bytes,
			   bool own_only)
{
	const uint64_t has = room_bytes(connection);
	if (has > 0 && has + bytes > LIMIT_IMAGE_BYTES)
		return ROOM_CONNECTION_FULL;
	const enum room_kind kind = room_choose(all, connection, bytes, own_only);
	if (kind == ROOM_NONE)
		return ROOM_COMMON_FULL;
	*place = (struct room_place){.kind = kind, .bytes = bytes};
	room_put(all, connection, place);
	return ROOM_TAKEN;
}

void room_give_back(struct room *all, struct room *connection, struct room_place *place)
{
	if (place->kind == ROOM_OWN) {
		all->own -= place->bytes;
		connection->own -= place->bytes;
	} else if (place->kind == ROOM_COMMON) {
		all->common -= place->bytes;
		connection->common -= place->bytes;
	}
	*place = (struct room_place){.kind = ROOM_NONE};
}

void room_resize(struct room *all, struct room *connection, struct room_place *place, uint64_t bytes)
{
	const struct room_place now = {.kind = place->kind, .bytes = bytes};
	room_give_back(all, connection, place);
	*place = now;
	room_put(all, connection, place);
}
