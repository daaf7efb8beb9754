// What every part of a study leans on.
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "clients/cli/study.h"

double study_clock(void)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

void study_learn_cold(struct study *study, unsigned technique, double elapsed_us, double cold_us)
{
	study->cold_s[technique] = cold_us * 1e-6;
	study->ready_s[technique] = fmax(0, elapsed_us - cold_us) * 1e-6;
}

void study_note(struct study *study, const char *format, ...)
{
	va_list args;
	if (study->note_count == sizeof(study->notes) / sizeof(*study->notes))
		return;
	va_start(args, format);
	vsnprintf(study->notes[study->note_count++], sizeof(study->notes[0]), format, args);
	va_end(args);
}

bool study_has_noise(unsigned technique)
{
	return technique_traits(technique) & TECHNIQUE_NOISE;
}

const char *study_kind_name(enum study_kind kind)
{
	static const char *const names[] = {"reference", "point", "ablation", "cold"};
	return names[kind];
}

// FNV-1a, 64 bits: http://www.isthe.com/chongo/tech/comp/fnv/.
uint64_t study_hash(uint64_t hash, const char *text)
{
	do {
		hash = (hash ^ (uint8_t)*text) * 0x100000001b3u;
	} while (*text++);
	return hash;
}

double study_round(double x, int digits)
{
	char text[32];
	snprintf(text, sizeof(text), "%.*e", digits - 1, x);
	return strtod(text, NULL);
}

void study_quote(char *text, size_t capacity, const char *word, bool *full)
{
	static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./,:=+-@%";
	size_t used = strlen(text);
	const bool bare = *word && word[strspn(word, plain)] == '\0';
	used += (size_t)snprintf(text + used, capacity - used, bare ? " %s" : " '", word);
	for (; !bare && *word && used < capacity; word++)
		used += (size_t)snprintf(text + used, capacity - used, *word == '\'' ? "'\\''" : "%c", *word);
	if (!bare && used < capacity)
		used += (size_t)snprintf(text + used, capacity - used, "'");
	*full |= used >= capacity;
}

bool study_path(const struct study *study, const char *name, char *path, size_t capacity)
{
	const int length = snprintf(path, capacity, "%s/%s", study->folder, name);
	errno = ENAMETOOLONG;
	return length > 0 && (size_t)length < capacity;
}
