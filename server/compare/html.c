#include "server/compare/html.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "server/base/replace.h"

enum status html_init(struct html *html, struct error *err)
{
	*html = (struct html){0};
	html->out = open_memstream(&html->text, &html->bytes);
	return html->out ? STATUS_OK : error_set(err, STATUS_MEMORY, "no memory for a page");
}

void html_finish(struct html *html)
{
	if (html->out)
		fclose(html->out);
	free(html->text);
	*html = (struct html){0};
}

void html_raw(struct html *html, const char *markup)
{
	fputs(markup, html->out);
}

void html_text(struct html *html, const char *text)
{
	for (; *text; text++) {
		const char *named = *text == '&'    ? "&amp;"
				    : *text == '<'  ? "&lt;"
				    : *text == '>'  ? "&gt;"
				    : *text == '"'  ? "&quot;"
				    : *text == '\'' ? "&#39;"
						    : NULL;
		if (named)
			fputs(named, html->out);
		else if ((unsigned char)*text >= ' ' || *text == '\n' || *text == '\t') // others are no characters of HTML
			fputc(*text, html->out);
	}
}

// One conversion, of which `spec` has all from '%' to its letter.
static void put_value(struct html *html, const char *spec, size_t length, va_list *args)
{
	char copy[16], text[64] = "";
	const char letter = spec[length - 1];
	if (length >= sizeof copy) {
		html->failed = true;
		return;
	}
	memcpy(copy, spec, length);
	copy[length] = '\0';
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
	const bool is_real = strchr("gfe", letter), is_size = strchr(copy, 'z');
	if (letter == 's')
		html_text(html, va_arg(*args, const char *));
	if (letter == '%')
		fputc('%', html->out);
	if (is_real)
		snprintf(text, sizeof text, copy, va_arg(*args, double));
	if (is_size)
		snprintf(text, sizeof text, copy, va_arg(*args, size_t));
	if (strchr("du", letter) && !is_size)
		snprintf(text, sizeof text, copy, va_arg(*args, int));
#pragma GCC diagnostic pop
	fputs(text, html->out);
}

void html_put(struct html *html, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	while (*format) {
		const size_t plain = strcspn(format, "%");
		fwrite(format, 1, plain, html->out);
		format += plain;
		if (*format == '\0')
			break;
		const size_t length = 1 + strcspn(format + 1, "%sdugfe") + 1;
		put_value(html, format, length, &args);
		format += length;
	}
	va_end(args);
}

void html_json(struct html *html, const json_t *value)
{
	char *text = json_dumps(value, JSON_COMPACT | JSON_REAL_PRECISION(6));
	html->failed = html->failed || !text;
	for (const char *c = text ? text : ""; *c; c++) {
		if (*c == '<' || *c == '&')
			fprintf(html->out, "\\u%04x", (unsigned)*c);
		else
			fputc(*c, html->out);
	}
	free(text);
}

void html_script(struct html *html, const char *text, size_t bytes)
{
	for (size_t i = 0; i < bytes; i++) {
		fputc(text[i], html->out);
		if (text[i] == '<' && i + 1 < bytes && text[i + 1] == '/')
			fputc('\\', html->out);
	}
}

void html_data(struct html *html, const char *type, const uint8_t *bytes, size_t size)
{
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	fprintf(html->out, "data:%s;base64,", type);
	for (size_t i = 0; i < size; i += 3) {
		const size_t left = size - i < 3 ? size - i : 3;
		uint32_t three = (uint32_t)bytes[i] << 16;
		three |= left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0;
		three |= left > 2 ? (uint32_t)bytes[i + 2] : 0;
		for (size_t k = 0; k < 4; k++)
			fputc(k <= left ? digits[three >> (18 - 6 * k) & 63] : '=', html->out);
	}
}

void html_template(struct html *html, const char *text, const struct html_slot *slots, const void *context)
{
	const char *open;
	while ((open = strstr(text, "{{")) != NULL) {
		const char *close = strstr(open, "}}");
		const struct html_slot *slot = slots;
		fwrite(text, 1, (size_t)(open - text), html->out);
		if (!close)
			break;
		while (slot->name && (strlen(slot->name) != (size_t)(close - open - 2) ||
				      strncmp(slot->name, open + 2, (size_t)(close - open - 2)) != 0))
			slot++;
		html->failed = html->failed || !slot->name;
		if (slot->name)
			slot->fill(html, context);
		text = close + 2;
	}
	html_raw(html, text);
}

size_t html_size(struct html *html)
{
	fflush(html->out);
	return html->bytes;
}

enum status html_save(struct html *html, const char *path, struct error *err)
{
	if (fflush(html->out) != 0 || ferror(html->out) || html->failed)
		return error_set(err, STATUS_MEMORY, "no memory for a page");
	return replace_asked(path, html->text, html->bytes, err);
}
