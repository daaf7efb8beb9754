#include "server/worker/libraries.h"

#include <fcntl.h>
#include <limits.h>
#include <link.h>
#include <pwd.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEPTH_MOST 8u
#define FILES_MOST 256u // looked into for one call: what many share is looked into again

struct search {
	struct landlock *landlock;
	unsigned files;
};

struct object {
	const char *bytes;
	size_t size;
	const ElfW(Phdr) * segments;
	size_t segment_count;
	const ElfW(Dyn) * entries;
	size_t entry_count;
	const char *strings; // of `string_bytes`, the last a zero
	size_t string_bytes;
};

static void visit(struct search *s, const char *path, unsigned depth);

// `bytes` of the file at `offset`; NULL: it has fewer.
static const void *part(const struct object *o, size_t offset, size_t bytes)
{
	return offset <= o->size && bytes <= o->size - offset ? o->bytes + offset : NULL;
}

// The same at an address of the linked object.
static const void *at_address(const struct object *o, size_t address, size_t bytes)
{
	for (size_t i = 0; i < o->segment_count; i++) {
		const ElfW(Phdr) *p = &o->segments[i];
		if (p->p_type == PT_LOAD && address >= p->p_vaddr && address - p->p_vaddr < p->p_filesz)
			return part(o, p->p_offset + (address - p->p_vaddr), bytes);
	}
	return NULL;
}

static size_t value_of(const struct object *o, ElfW(Sxword) tag)
{
	for (size_t i = 0; i < o->entry_count && o->entries[i].d_tag != DT_NULL; i++)
		if (o->entries[i].d_tag == tag)
			return o->entries[i].d_un.d_val;
	return 0;
}

static bool read_object(struct object *o)
{
	const ElfW(Ehdr) *head = part(o, 0, sizeof *head);
	if (!head || memcmp(head->e_ident, ELFMAG, SELFMAG) != 0 ||
	    head->e_ident[EI_CLASS] != (sizeof(void *) == 8 ? ELFCLASS64 : ELFCLASS32) ||
	    head->e_phentsize != sizeof *o->segments || head->e_phoff % _Alignof(ElfW(Phdr)))
		return false;
	o->segments = part(o, head->e_phoff, head->e_phnum * sizeof *o->segments);
	o->segment_count = o->segments ? head->e_phnum : 0;
	for (size_t i = 0; i < o->segment_count; i++)
		if (o->segments[i].p_type == PT_DYNAMIC && o->segments[i].p_offset % _Alignof(ElfW(Dyn)) == 0) {
			o->entries = part(o, o->segments[i].p_offset, o->segments[i].p_filesz);
			o->entry_count = o->entries ? o->segments[i].p_filesz / sizeof *o->entries : 0;
		}
	o->string_bytes = value_of(o, DT_STRSZ);
	o->strings = o->string_bytes ? at_address(o, value_of(o, DT_STRTAB), o->string_bytes) : NULL;
	return o->strings && !o->strings[o->string_bytes - 1];
}

// A folder of the list, where $ORIGIN is that of the object itself. false: there is none, or its path is too long.
static bool next_folder(const char **list, const char *origin, char folder[PATH_MAX])
{
	const char *end = strchrnul(*list, ':');
	const size_t length = (size_t)(end - *list);
	const char *text = *list;
	const size_t mark = !strncmp(text, "$ORIGIN", 7) ? 7 : !strncmp(text, "${ORIGIN}", 9) ? 9 : 0;
	const int written = snprintf(folder, PATH_MAX, "%s%.*s", mark ? origin : "", (int)(length - mark), text + mark);
	*list = *end ? end + 1 : end;
	return folder[0] == '/' && written < PATH_MAX;
}

// Is `home` the real folder, or does it lie beneath it?
static bool has_home(const char *folder, const char *home)
{
	char real[PATH_MAX];
	const size_t length = strlen(folder);
	return home && realpath(home, real) && !strncmp(real, folder, length) && (!real[length] || real[length] == '/');
}

// Would the real folder be far more than libraries? The root, what lies right beneath it, homes, and what homes lie in. The
// account's home is taken from the file: other sources of accounts may start threads, which the fence would not hold.
static bool is_wide(const char *folder)
{
	bool wide = strrchr(folder, '/') == folder || (!strncmp(folder, "/home/", 6) && !strchr(folder + 6, '/')) ||
		    has_home(folder, getenv("HOME"));
	FILE *accounts = wide ? NULL : fopen("/etc/passwd", "re");
	for (const struct passwd *p; accounts && !wide && (p = fgetpwent(accounts));)
		wide = p->pw_uid == getuid() && has_home(folder, p->pw_dir);
	if (accounts)
		fclose(accounts);
	return wide;
}

// false: there is no such folder, or it is more than may be read.
static bool allow_folder(struct landlock *l, const char *folder)
{
	char real[PATH_MAX];
	if (!realpath(folder, real) || is_wide(real))
		return false;
	landlock_allow(l, real, USE_READ);
	return true;
}

// What the object needs and finds in the folder is looked into likewise.
static void visit_needed(struct search *s, const struct object *o, const char *folder, unsigned depth)
{
	char path[PATH_MAX];
	for (size_t i = 0; i < o->entry_count && o->entries[i].d_tag != DT_NULL; i++) {
		const size_t name = o->entries[i].d_un.d_val;
		if (o->entries[i].d_tag != DT_NEEDED || name >= o->string_bytes)
			continue;
		const int length = snprintf(path, sizeof path, "%s/%s", folder, o->strings + name);
		if (length > 0 && (size_t)length < sizeof path && access(path, R_OK) == 0)
			visit(s, path, depth + 1);
	}
}

static void visit_object(struct search *s, const struct object *o, const char *origin, unsigned depth)
{
	const size_t run = value_of(o, DT_RUNPATH), name = run ? run : value_of(o, DT_RPATH);
	char folder[PATH_MAX];
	if (name == 0 || name >= o->string_bytes)
		return;
	for (const char *list = o->strings + name; *list;) {
		if (!next_folder(&list, origin, folder))
			continue;
		(void)allow_folder(s->landlock, folder);
		visit_needed(s, o, folder, depth);
	}
}

static void visit(struct search *s, const char *path, unsigned depth)
{
	char real[PATH_MAX];
	struct stat about;
	if (depth == DEPTH_MOST || s->files == FILES_MOST || !realpath(path, real))
		return;
	s->files++;
	const int fd = open(real, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (fd < 0)
		return;
	struct object o = {0};
	if (fstat(fd, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0) {
		o.size = (size_t)about.st_size;
		o.bytes = mmap(NULL, o.size, PROT_READ, MAP_PRIVATE, fd, 0);
	}
	close(fd);
	if (!o.bytes || o.bytes == MAP_FAILED)
		return;
	char *slash = strrchr(real, '/');
	*slash = 0;
	if (!allow_folder(s->landlock, real)) {
		*slash = '/';
		landlock_allow(s->landlock, real, USE_READ);
		*slash = 0;
	}
	if (read_object(&o))
		visit_object(s, &o, real, depth);
	munmap((void *)(uintptr_t)o.bytes, o.size);
}

void libraries_allow(struct landlock *l, const char *path)
{
	struct search search = {.landlock = l};
	visit(&search, path, 0);
}
