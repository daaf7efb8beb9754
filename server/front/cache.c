#include "server/front/cache.h"

#include <stdio.h>
#include <sys/stat.h>

#include "protocol/text.h"
#include "server/base/drivers.h"

void cache_find(struct cache *cache)
{
	struct stat about;
	const bool kept = drivers_cache(cache->path) && stat(cache->path, &about) == 0;
	if (!kept) {
		cache->path[0] = 0;
		return;
	}
	cache->device = about.st_dev;
	cache->inode = about.st_ino;
}

void cache_note(const struct cache *cache, char note[LIMIT_TEXT + 1])
{
	char path[121]; // clean, which a path need not be
	struct stat about;
	note[0] = 0;
	if (!cache->path[0] ||
	    (stat(cache->path, &about) == 0 && about.st_dev == cache->device && about.st_ino == cache->inode))
		return;
	text_copy(path, sizeof path, cache->path);
	snprintf(note, LIMIT_TEXT + 1,
		 "%s was removed or replaced: what is compiled is not kept until candild is started again", path);
}
