#include "server/front/jobs/room.h"

#include "protocol/limits.h"

// No sum of these passes 2^64: an image has at most LIMIT_PIXELS, and a job has two images.
uint64_t room_bytes(const struct room *room)
{
	return room->own + room->common;
}

static enum room_kind room_choose(const struct room_owner *owner, uint64_t bytes, bool own_only)
{
	const struct room *all = owner->all, *connection = owner->connection;
	if (connection->images > 0 && all->images >= owner->most_images)
		return ROOM_NONE;
	if (connection->own + bytes <= LIMIT_OWN_IMAGE_BYTES)
		return ROOM_OWN;
	if (!own_only && (all->common == 0 || all->common + bytes <= LIMIT_COMMON_IMAGE_BYTES))
		return ROOM_COMMON;
	return ROOM_NONE;
}

static void room_put(const struct room_owner *owner, const struct room_place *place)
{
	if (place->kind == ROOM_NONE)
		return;
	if (place->kind == ROOM_OWN) {
		owner->all->own += place->bytes;
		owner->connection->own += place->bytes;
	} else {
		owner->all->common += place->bytes;
		owner->connection->common += place->bytes;
	}
	owner->all->images += owner->connection->images++ > 0;
}

enum room_answer room_take(const struct room_owner *owner, struct room_place *place, uint64_t bytes, bool own_only)
{
	const uint64_t has = room_bytes(owner->connection);
	if (has > 0 && has + bytes > LIMIT_IMAGE_BYTES)
		return ROOM_CONNECTION_FULL;
	const enum room_kind kind = room_choose(owner, bytes, own_only);
	if (kind == ROOM_NONE)
		return ROOM_COMMON_FULL;
	*place = (struct room_place){.kind = kind, .bytes = bytes};
	room_put(owner, place);
	return ROOM_TAKEN;
}

void room_give_back(const struct room_owner *owner, struct room_place *place)
{
	if (place->kind == ROOM_NONE)
		return;
	if (place->kind == ROOM_OWN) {
		owner->all->own -= place->bytes;
		owner->connection->own -= place->bytes;
	} else {
		owner->all->common -= place->bytes;
		owner->connection->common -= place->bytes;
	}
	owner->all->images -= --owner->connection->images > 0;
	*place = (struct room_place){.kind = ROOM_NONE};
}

void room_resize(const struct room_owner *owner, struct room_place *place, uint64_t bytes)
{
	const struct room_place now = {.kind = place->kind, .bytes = bytes};
	room_give_back(owner, place);
	*place = now;
	room_put(owner, place);
}
