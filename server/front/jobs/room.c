#include "server/front/jobs/room.h"

#include "protocol/limits.h"
#include "server/front/share.h"

// No sum of these passes 2^64: an image has at most LIMIT_PIXELS, and a job has two images.
uint64_t room_bytes(const struct room *room)
{
	return room->own + room->common;
}

static enum room_answer room_choose(const struct room_owner *owner, uint64_t bytes, bool own_only, enum room_kind *kind)
{
	const struct room *all = owner->all, *peer = owner->peer, *connection = owner->connection;
	const uint64_t left = all->common < LIMIT_COMMON_IMAGE_BYTES ? LIMIT_COMMON_IMAGE_BYTES - all->common : 0;
	if (connection->images > 0 && all->images >= owner->most_images)
		return ROOM_COMMON_FULL;
	if (connection->images > 0 && !share_allows(peer->images, 1, owner->most_images - all->images))
		return ROOM_SHARE_FULL;
	*kind = ROOM_OWN;
	if (connection->own + bytes <= LIMIT_OWN_IMAGE_BYTES)
		return ROOM_TAKEN;
	*kind = ROOM_COMMON;
	if (own_only)
		return ROOM_SHARE_FULL;
	if (all->common == 0)
		return ROOM_TAKEN;
	if (bytes > left)
		return ROOM_COMMON_FULL;
	return share_allows(peer->common, bytes, left) ? ROOM_TAKEN : ROOM_SHARE_FULL;
}

static void room_put(const struct room_owner *owner, const struct room_place *place)
{
	if (place->kind == ROOM_NONE)
		return;
	if (place->kind == ROOM_OWN) {
		owner->all->own += place->bytes;
		owner->peer->own += place->bytes;
		owner->connection->own += place->bytes;
	} else {
		owner->all->common += place->bytes;
		owner->peer->common += place->bytes;
		owner->connection->common += place->bytes;
	}
	if (owner->connection->images++ > 0) {
		owner->all->images++;
		owner->peer->images++;
	}
}

enum room_answer room_take(const struct room_owner *owner, struct room_place *place, uint64_t bytes, bool own_only)
{
	const uint64_t has = room_bytes(owner->connection);
	if (has > 0 && has + bytes > LIMIT_IMAGE_BYTES)
		return ROOM_CONNECTION_FULL;
	enum room_kind kind = ROOM_NONE;
	const enum room_answer answer = room_choose(owner, bytes, own_only, &kind);
	if (answer != ROOM_TAKEN)
		return answer;
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
		owner->peer->own -= place->bytes;
		owner->connection->own -= place->bytes;
	} else {
		owner->all->common -= place->bytes;
		owner->peer->common -= place->bytes;
		owner->connection->common -= place->bytes;
	}
	if (--owner->connection->images > 0) {
		owner->all->images--;
		owner->peer->images--;
	}
	*place = (struct room_place){.kind = ROOM_NONE};
}

void room_resize(const struct room_owner *owner, struct room_place *place, uint64_t bytes)
{
	const struct room_place now = {.kind = place->kind, .bytes = bytes};
	room_give_back(owner, place);
	*place = now;
	room_put(owner, place);
}
