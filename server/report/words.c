#include "server/report/words.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *words_seconds(double seconds, char out[WORDS_NUMBER])
{
	if (!isfinite(seconds))
		snprintf(out, WORDS_NUMBER, "unknown");
	else if (seconds < 0.00995)
		snprintf(out, WORDS_NUMBER, "%.1f ms", 1000 * seconds);
	else if (seconds < 0.9995)
		snprintf(out, WORDS_NUMBER, "%.0f ms", 1000 * seconds);
	else if (seconds < 99.5)
		snprintf(out, WORDS_NUMBER, seconds < 9.95 ? "%.1f s" : "%.0f s", seconds);
	else
		snprintf(out, WORDS_NUMBER, "%.0f min %.0f s", floor(round(seconds) / 60), fmod(round(seconds), 60));
	return out;
}

// How many decimals leave two significant digits.
static int decimals_of(double x)
{
	return (int)fmax(0, 1 - floor(log10(fabs(x) * 1.005)));
}

const char *words_error(double error, char out[WORDS_NUMBER])
{
	static const char *const digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
	char plain[16], *e;
	if (!isfinite(error))
		snprintf(out, WORDS_NUMBER, "unknown");
	else if (error == 0)
		snprintf(out, WORDS_NUMBER, "0");
	else if (fabs(error) >= 99.5 && fabs(error) < 999500) // two digits, and zeros
		snprintf(out, WORDS_NUMBER, "%.0f", atof((snprintf(plain, sizeof plain, "%.1e", error), plain)));
	else if (fabs(error) >= 0.000995 && fabs(error) < 99.5)
		snprintf(out, WORDS_NUMBER, "%.*f", decimals_of(error), error);
	else {
		snprintf(plain, sizeof plain, "%.1e", error);
		e = strchr(plain, 'e');
		const int exponent = e ? atoi(e + 1) : 0, size = abs(exponent);
		if (e)
			*e = '\0';
		snprintf(out, WORDS_NUMBER, "%s·10%s%s%s%s", plain, exponent < 0 ? "⁻" : "",
			 size >= 100 ? digits[size / 100] : "", size >= 10 ? digits[size / 10 % 10] : "", digits[size % 10]);
	}
	return out;
}

const char *words_share(double share, char out[WORDS_NUMBER])
{
	if (isfinite(share))
		snprintf(out, WORDS_NUMBER, fabs(share) < 0.0995 && share != 0 ? "%.1f %%" : "%.0f %%", 100 * share);
	else
		snprintf(out, WORDS_NUMBER, "unknown");
	return out;
}

char *words_settings(const json_t *settings)
{
	char *text = strdup("");
	const char *key;
	json_t *value;
	// The samples first, which every technique has.
	for (int rest = 0; rest < 2; rest++) {
		json_object_foreach((json_t *)settings, key, value)
		{
			if ((strcmp(key, "samples") != 0) != rest)
				continue;
			char *dumped = json_is_string(value) ? strdup(json_string_value(value))
							     : json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(6));
			char *longer = NULL;
			if (!text || !dumped || asprintf(&longer, "%s%s%s %s", text, text[0] ? ", " : "", key, dumped) < 0)
				longer = NULL;
			free(dumped);
			free(text);
			text = longer;
		}
	}
	return text;
}

static void __attribute__((format(printf, 2, 3))) say(json_t *words, const char *format, ...)
{
	char *text = NULL;
	va_list args;
	va_start(args, format);
	if (vasprintf(&text, format, args) >= 0)
		json_array_append_new(words, json_string(study_whole_text(text)));
	va_end(args);
	free(text);
}

static void say_point(const struct point *p, char out[160])
{
	char error[WORDS_NUMBER], seconds[WORDS_NUMBER], *settings = words_settings(p->runs[0].settings);
	snprintf(out, 160, "relMSE %s in %s with %.90s", words_error(p->relmse, error), words_seconds(p->seconds, seconds),
		 settings ? settings : "?");
	free(settings);
}

static void say_spans(const struct judgement *j, const struct judge_view *v, const char *of, json_t *words)
{
	char from[WORDS_NUMBER], until[WORDS_NUMBER], point[160];
	for (size_t i = 0; i < v->span_count; i++) {
		const struct judge_span *span = &v->spans[i];
		const char *name = j->techniques[span->technique].name;
		words_seconds(span->first->seconds, from);
		say_point(span->best, point);
		if (!span->best->resolved)
			say(words,
			    "%s%s is within the reference's own error from %s on: this reference cannot tell what is "
			    "better.",
			    of, name, from);
		else if (v->span_count == 1)
			say(words, "%s%s is the most accurate from its first picture after %s on: %s at best.", of, name,
			    from, point);
		else if (i + 1 < v->span_count)
			say(words, "%s%s is the most accurate %s%s to %s: %s at best.", of, name,
			    i == 0 ? "from its first picture after " : "from ", from,
			    words_seconds(v->spans[i + 1].first->seconds, until), point);
		else
			say(words, "%s%s is the most accurate from %s on: %s at best.", of, name, from, point);
		if (!span->best->resolved || !span->rival)
			continue;
		say_point(span->rival, point);
		say(words,
		    judge_comparable(span->best, span->rival)
			? "%sIts interval overlaps that of %s, which is not told apart from it: %s."
			: "%sNo interval is known that would tell %s apart from it: %s.",
		    of, span->rival->runs[0].technique, point);
	}
}

// What of a floor's error the map of bias makes.
static void say_bias(const struct point *p, char out[96])
{
	char share[WORDS_NUMBER];
	out[0] = '\0';
	if (p->bias.tiles > 0 && p->bias.share > 0)
		snprintf(out, 96, ": that is bias, in %s of the picture's tiles", words_share(p->bias.share, share));
	else if (p->bias.tiles > 0)
		snprintf(out, 96, "; no tile of the picture is told from noise");
}

// A floor that is one: its level, and by which samples it is known to be one.
static void say_held(const struct judge_floor *floor, const char *of, const char *name, json_t *words)
{
	char level[WORDS_NUMBER], low[WORDS_NUMBER], high[WORDS_NUMBER], interval[3 * WORDS_NUMBER] = "";
	char known[96], bias[96];
	words_error(floor->interval.low, low);
	words_error(floor->interval.high, high);
	if (floor->interval.low < floor->interval.high && strcmp(low, high) != 0)
		snprintf(interval, sizeof interval, " (%s … %s)", low, high);
	if (floor->by_others)
		snprintf(known, sizeof known,
			 "Those settings alone do not say so; with others more samples changed nothing");
	else
		snprintf(known, sizeof known, "From samples %.0f to %.0f it did not fall", floor->before->runs[0].samples,
			 floor->point->runs[0].samples);
	say_bias(floor->point, bias);
	say(words, "%s%s gets no lower than relMSE %s%s with the settings of this study, noise taken off%s. %s.", of, name,
	    words_error(floor->level, level), interval, bias, known);
}

static void say_floors(const struct judgement *j, const struct judge_view *v, const char *of, json_t *words)
{
	char error[WORDS_NUMBER], earlier[WORDS_NUMBER], share[WORDS_NUMBER];
	for (size_t t = 0; t < j->technique_count; t++) {
		const struct judge_floor *floor = &v->floors[t];
		const struct point *p = floor->point;
		const char *name = j->techniques[t].name;
		if (!p)
			continue;
		words_error(p->relmse, error);
		if (p->resolved && floor->fall == JUDGE_FALLING && !floor->by_others)
			say(words,
			    "%s%s is still falling with samples %.0f: relMSE %s, after %s with %.0f. Its floor is unknown.",
			    of, name, p->runs[0].samples, error, words_error(floor->before->relmse, earlier),
			    floor->before->runs[0].samples);
		else if (!floor->resolved)
			say(words,
			    "%s%s has no floor that this reference could tell: without its noise its error is within the "
			    "reference's own.",
			    of, name);
		else if (floor->fall == JUDGE_HELD)
			say_held(floor, of, name, words);
		else
			say(words,
			    "%s%s was at relMSE %s (noise: %s) with samples %.0f; whether more samples lower the rest "
			    "this study does not say.",
			    of, name, error, words_share(p->relmse_noise / p->relmse, share), p->runs[0].samples);
	}
}

static void say_overtakes(const struct judgement *j, const struct judge_view *v, const char *of, json_t *words)
{
	char seconds[WORDS_NUMBER];
	for (size_t i = 0; i < v->overtake_count; i++) {
		const struct judge_overtake *o = &v->overtakes[i];
		const char *winner = j->techniques[o->winner].name, *loser = j->techniques[o->loser].name;
		char *settings = o->point ? words_settings(o->point->runs[0].settings) : NULL;
		if (o->point)
			say(words,
			    o->from_first ? "%s%s is ahead of %s from its first picture, at %s with %s, and stays ahead."
					  : "%s%s overtakes %s at %s, with %s, and stays ahead.",
			    of, winner, loser, words_seconds(o->seconds, seconds), settings ? settings : "?");
		else if (o->closer)
			say(words, "%s%s is at best not told apart from %s: %s.", of, winner, loser,
			    o->comparable ? "their intervals overlap" : "no interval is known");
		else
			say(words, "%s%s does not overtake %s within this study.", of, winner, loser);
		free(settings);
	}
}

json_t *words_of(const struct figures *f, const struct judgement *j)
{
	json_t *words = json_array();
	char name[32], of[LIMIT_NAME + 16];
	for (uint32_t view = 0; words && view < j->view_count; view++) {
		of[0] = '\0';
		if (j->view_count > 1)
			snprintf(of, sizeof of, "In %.60s, ", study_view_name(f->study, view, name));
		say_spans(j, &j->views[view], of, words);
		say_floors(j, &j->views[view], of, words);
		say_overtakes(j, &j->views[view], of, words);
	}
	if (words && json_array_size(words) == 0)
		say(words, "No point has both an error and a time, so nothing can be said of what accuracy costs.");
	const size_t missing = json_array_size(f->study->missing);
	if (words && missing > 0)
		say(words, "This report is not whole: %zu %s missing or in part, and listed below.", missing,
		    missing == 1 ? "thing is" : "things are");
	return words;
}
