#include "server/worker/scenes/edit_names.h"

#include <stdlib.h>
#include <string.h>

struct name_list names_of(const struct blob_view *view, enum blob_section section, const char *kind)
{
	return (struct name_list){view->sections[section], blob_stride(section), view->counts[section], kind};
}

static bool is_number(const char *name, uint32_t i)
{
	if (name[0] != '#' || name[1] < '0' || name[1] > '9')
		return false;
	char *end;
	const unsigned long number = strtoul(name + 1, &end, 10);
	return !*end && number == i;
}

bool name_matches(const struct name_list *list, uint32_t i, const char *name)
{
	return strcmp(list->first + i * list->stride, name) == 0 || is_number(name, i);
}

enum status name_unknown(const struct name_list *list, const char *name, struct error *err)
{
	return error_set(err, STATUS_BAD_ARGUMENT, "the scene has no %s '%s': `candil describe` lists them", list->kind,
			 name);
}

enum status name_find(const struct name_list *list, const char *name, uint32_t *index, struct error *err)
{
	uint32_t found = 0;
	for (uint32_t i = 0; i < list->count; i++)
		if (name_matches(list, i, name) && found++ == 0)
			*index = i;
	if (found == 0)
		return name_unknown(list, name, err);
	if (found > 1)
		return error_set(err, STATUS_BAD_ARGUMENT,
				 "the scene has %u %ss that '%s' names: say which by its number in the list of `candil "
				 "describe`, from 0, such as '#%u'",
				 found, list->kind, name, *index);
	return STATUS_OK;
}
