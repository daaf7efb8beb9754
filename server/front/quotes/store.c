#include "server/front/quotes/store.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include "server/base/clock.h"
#include "server/base/folders.h"
#include "server/base/log.h"
#include "server/base/replace.h"

#define QUOTE_FILE_MAGIC 0x544F5551u // "QUOT" read as little-endian
#define QUOTE_FILE_VERSION 2u

struct file_head {
	uint32_t magic, version;
	uint32_t habit_bytes, record_bytes; // of one
	uint32_t habits, records; // how many
	uint64_t sum; // XXH64 of all that follows, seeded with the fields above
};

#define FILE_MOST (sizeof(struct file_head) + sizeof(struct quote_model))

static uint64_t sum_of(const struct file_head *head, const uint8_t *rest, size_t bytes)
{
	return XXH64(rest, bytes, XXH64(head, offsetof(struct file_head, sum), 0));
}

uint8_t *quote_store_encode(const struct quote_model *m, size_t *bytes)
{
	struct file_head head = {.magic = QUOTE_FILE_MAGIC,
				 .version = QUOTE_FILE_VERSION,
				 .habit_bytes = sizeof *m->habits,
				 .record_bytes = sizeof *m->records,
				 .habits = LIMIT_QUOTE_DEVICES,
				 .records = m->count};
	const size_t rest = sizeof m->habits + m->count * sizeof *m->records;
	uint8_t *data = malloc(sizeof head + rest), *at = data ? data + sizeof head : NULL;
	if (!data)
		return NULL;
	memcpy(at, m->habits, sizeof m->habits);
	at += sizeof m->habits;
	for (uint32_t i = 0; i < m->count; i++, at += sizeof *m->records)
		memcpy(at, &m->records[(m->oldest + i) % LIMIT_QUOTE_RECORDS], sizeof *m->records);
	head.sum = sum_of(&head, data + sizeof head, rest);
	memcpy(data, &head, sizeof head);
	*bytes = sizeof head + rest;
	return data;
}

static enum status check_head(const struct file_head *head, const uint8_t *data, size_t bytes, struct error *err)
{
	if (head->magic != QUOTE_FILE_MAGIC)
		return error_set(err, STATUS_BAD_MESSAGE, "it is no file of quotes");
	if (head->version != QUOTE_FILE_VERSION || head->habit_bytes != sizeof(struct quote_habits) ||
	    head->record_bytes != sizeof(struct quote_record) || head->habits != LIMIT_QUOTE_DEVICES)
		return error_set(err, STATUS_BAD_MESSAGE, "it is of another version");
	const size_t rest = bytes - sizeof *head;
	if (head->records > LIMIT_QUOTE_RECORDS ||
	    rest != LIMIT_QUOTE_DEVICES * sizeof(struct quote_habits) + head->records * sizeof(struct quote_record))
		return error_set(err, STATUS_BAD_MESSAGE, "it has not as many bytes as it says");
	if (head->sum != sum_of(head, data + sizeof *head, rest))
		return error_set(err, STATUS_BAD_MESSAGE, "its checksum is wrong");
	return STATUS_OK;
}

// The checksum keeps accidents away, and nothing else: every number is looked at.
enum status quote_store_decode(const uint8_t *data, size_t bytes, struct quote_model *m, struct error *err)
{
	struct file_head head;
	if (bytes < sizeof head)
		return error_set(err, STATUS_BAD_MESSAGE, "it is too short");
	memcpy(&head, data, sizeof head);
	enum status status = check_head(&head, data, bytes, err);
	if (status != STATUS_OK)
		return status;
	const uint8_t *at = data + sizeof head;
	memcpy(m->habits, at, sizeof m->habits);
	at += sizeof m->habits;
	memcpy(m->records, at, head.records * sizeof *m->records);
	m->count = head.records;
	bool good = true;
	for (unsigned i = 0; i < LIMIT_QUOTE_DEVICES; i++)
		good = good && quote_habits_hold(&m->habits[i]);
	for (uint32_t i = 0; i < m->count; i++)
		good = good && quote_record_holds(&m->records[i]);
	if (good)
		return STATUS_OK;
	memset(m, 0, sizeof *m);
	return error_set(err, STATUS_BAD_MESSAGE, "a number in it cannot be");
}

// ---- the file --------------------------------------------------------------------------------------------------------

static bool file_name(const struct quote_store *store, char out[PATH_MAX])
{
	const int length = snprintf(out, PATH_MAX, "%s/quotes", store->folder);
	return length > 0 && length < PATH_MAX;
}

// All bytes of a plain file that is not too long, from malloc; NULL, with errno, if there is none.
static uint8_t *read_file(const char *name, size_t *bytes)
{
	struct stat about;
	const int fd = open(name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
	if (fd < 0)
		return NULL;
	uint8_t *data = NULL;
	*bytes = 0;
	if (fstat(fd, &about) == 0 && S_ISREG(about.st_mode) && about.st_size <= (off_t)FILE_MOST) {
		const size_t size = (size_t)about.st_size;
		data = malloc(size + 1);
		ssize_t got = 1;
		while (data && *bytes < size && got > 0) {
			got = read(fd, data + *bytes, size - *bytes);
			*bytes += got > 0 ? (size_t)got : 0;
		}
	} else {
		errno = EFBIG;
	}
	const int failure = errno;
	close(fd);
	errno = failure;
	return data;
}

// false: there is no file, or none that can be used.
static bool read_model(const struct quote_store *store, struct quote_model *model)
{
	char name[PATH_MAX];
	struct error err;
	size_t bytes;
	if (!store->folder[0] || !file_name(store, name))
		return false;
	uint8_t *data = read_file(name, &bytes);
	if (!data) {
		if (errno != ENOENT && errno != ENOTDIR)
			log_line(LOG_WARNING, "%.200s is left aside: %s", name, strerror(errno));
		return false;
	}
	const bool good = quote_store_decode(data, bytes, model, &err) == STATUS_OK;
	free(data);
	if (!good)
		log_line(LOG_WARNING, "%.200s is left aside: %s; it will be written anew", name, err.text);
	return good;
}

static bool has_record(const struct quote_model *m, const struct quote_record *r)
{
	for (uint32_t i = 0; i < m->count; i++)
		if (m->records[i].stamp == r->stamp && memcmp(&m->records[i], r, sizeof *r) == 0)
			return true;
	return false;
}

// What another daemon has written meanwhile goes along, as older than ours.
static void merge(struct quote_model *into, const struct quote_model *ours)
{
	for (uint32_t i = 0; i < ours->count; i++) {
		const struct quote_record *r = &ours->records[(ours->oldest + i) % LIMIT_QUOTE_RECORDS];
		// What could not be rendered may be when the daemon is next started.
		if (r->known != 0 && !has_record(into, r))
			quote_keep(into, r);
	}
	for (unsigned i = 0; i < LIMIT_QUOTE_DEVICES; i++)
		if (ours->habits[i].where != 0)
			*quote_make_habits(into, ours->habits[i].where) = ours->habits[i];
}

static enum status write_file(const struct quote_store *store, const uint8_t *data, size_t bytes, struct error *err)
{
	char name[PATH_MAX];
	if (!file_name(store, name))
		return error_set(err, STATUS_IO, "its name is too long");
	if (!make_folders(store->folder))
		return error_errno(err, STATUS_IO, "cannot make the folder");
	return replace_file(name, 0600, data, bytes, err);
}

static void save(void *owner)
{
	struct quote_store *store = owner;
	struct error err = {.text = "there is no memory"};
	size_t bytes = 0;
	struct quote_model *both = calloc(1, sizeof *both);
	if (!both)
		return;
	read_model(store, both);
	merge(both, store->model);
	uint8_t *data = quote_store_encode(both, &bytes);
	free(both);
	if (!data || write_file(store, data, bytes, &err) != STATUS_OK) {
		if (!store->failed)
			log_line(LOG_WARNING, "what is known of times and errors cannot be kept: %s", err.text);
		store->failed = true;
	}
	free(data);
	store->dirty = false;
}

void quote_store_open(struct quote_store *store, const char *folder, struct loop *loop, struct quote_model *model)
{
	*store = (struct quote_store){.loop = loop, .model = model};
	snprintf(store->folder, sizeof store->folder, "%s", folder);
	if (read_model(store, model))
		log_line(LOG_INFO, "%u records of times and errors from %s", model->count, store->folder);
}

void quote_store_mark(struct quote_store *store)
{
	if (store->dirty || !store->folder[0])
		return;
	store->dirty = true;
	loop_timer_set(store->loop, &store->timer, clock_us() + QUOTE_STORE_PAUSE_US, save, store);
}

void quote_store_close(struct quote_store *store)
{
	if (!store->loop)
		return;
	loop_timer_stop(store->loop, &store->timer);
	if (store->dirty)
		save(store);
}
