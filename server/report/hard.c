#include "server/report/hard.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define CELLS 16u

enum status hard_read(const char *path, char **text, struct error *err)
{
	struct stat about;
	FILE *file = fopen(path, "rbe");
	enum status s = STATUS_OK;
	*text = NULL;
	if (!file || fstat(fileno(file), &about) != 0)
		s = error_errno(err, STATUS_IO, "cannot read %s", path);
	else if (!S_ISREG(about.st_mode) || about.st_size > (off_t)LIMIT_REPORT_TABLE_BYTES)
		s = error_set(err, STATUS_LIMIT, "%s is no page of hard cases; the limit is %u bytes", path,
			      LIMIT_REPORT_TABLE_BYTES);
	else if ((*text = calloc((size_t)about.st_size + 1, 1)) == NULL)
		s = error_set(err, STATUS_MEMORY, "no memory for %s", path);
	else if (fread(*text, 1, (size_t)about.st_size, file) == 0)
		s = error_set(err, STATUS_IO, "%s is empty", path);
	if (file)
		fclose(file);
	return s;
}

// Cut a row of a table at its bars, and the cells' ends and code marks off. Returns how many cells.
static size_t split(char *line, char *cells[CELLS])
{
	size_t count = 0;
	for (char *at = line + 1; count < CELLS;) {
		char *end = strchr(at, '|');
		if (!end)
			break;
		*end = '\0';
		cells[count] = at + strspn(at, " `");
		for (char *last = end - 1; last >= cells[count] && (*last == ' ' || *last == '`'); last--)
			*last = '\0';
		count++;
		at = end + 1;
	}
	return count;
}

static void write_row(struct html *html, const char *tag, char *const *cells, size_t count)
{
	html_raw(html, "<tr>");
	for (size_t i = 0; i < count; i++) {
		html_raw(html, "<");
		html_raw(html, tag);
		html_raw(html, ">");
		html_text(html, cells[i]);
	}
	html_raw(html, "</tr>\n");
}

size_t hard_write(struct html *html, const char *text, const struct judgement *j)
{
	char *copy = strdup(text), *rest = NULL, *heading = NULL, *names[CELLS], *cells[CELLS];
	size_t rows = 0, technique = CELLS, columns = 0;
	bool open = false;
	html->failed = html->failed || !copy;
	for (char *line = copy ? strtok_r(copy, "\n", &rest) : NULL; line; line = strtok_r(NULL, "\n", &rest)) {
		if (strncmp(line, "## ", 3) == 0)
			heading = line + 3;
		if (line[0] != '|') {
			html_raw(html, open ? "</tbody></table></div>\n" : "");
			open = false;
			technique = CELLS;
			continue;
		}
		if (technique == CELLS) { // a table's first row has the names of its columns
			columns = split(line, names);
			for (technique = 0; technique < columns && strcmp(names[technique], "technique") != 0; technique++)
				;
			continue;
		}
		const size_t count = split(line, cells);
		if (technique >= count || judge_technique_of(j, cells[technique]) == j->technique_count)
			continue;
		if (!open) {
			html_put(html, "<div class=\"wide\"><table><caption>%s</caption><thead>", heading ? heading : "");
			write_row(html, "th scope=\"col\"", names, columns);
			html_raw(html, "</thead><tbody>\n");
			open = true;
		}
		write_row(html, "td", cells, count);
		rows++;
	}
	html_raw(html, open ? "</tbody></table></div>\n" : "");
	free(copy);
	return rows;
}
