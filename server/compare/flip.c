#include "server/compare/flip.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define RADIUS_MOST 16 // of the filters, pixels
#define BAND 128u // rows that are seen at a time, and RADIUS_MOST more each way: memory grows with the width alone

// Constants of the 2020 paper: section 4.1 (the widths of the eye's filters, and the exponent and the knee by which
// differences of colour become 0…1) and section 4.2 (the width of an edge, in degrees, and the exponent of features).
#define COLOUR_EXPONENT 0.7
#define KNEE 0.4
#define KNEE_VALUE 0.95
#define FEATURE_WIDTH 0.082
#define FEATURE_EXPONENT 0.5

// Contrast sensitivity as sums of two Gaussians, one row for each opponent channel: a1, b1, a2, b2 (table 1 of the paper).
static const double sensitivity[3][4] = {
    {1.0, 0.0047, 0.0, 1e-5},
    {1.0, 0.0053, 0.0, 1e-5},
    {34.1, 0.04, 13.5, 0.025},
};
#define WIDEST 0.04 // the largest b

// Linear Rec.709 to CIE XYZ under D65, and back.
static const double to_xyz[3][3] = {
    {0.4123865632529917, 0.3575914909206254, 0.1804504912035637},
    {0.2126368216773238, 0.7151829818412507, 0.0721801964814255},
    {0.0193306201524840, 0.1191971636402085, 0.9503725870054354},
};
static const double from_xyz[3][3] = {
    {3.2410032329763583, -1.5373989694887853, -0.4986158819963628},
    {-0.9692242522025163, 1.8759299836951757, 0.0415542263400847},
    {0.0556394198519754, -0.2040112061239099, 1.0571489771875333},
};

struct kernel {
	int radius;
	float tap[2 * RADIUS_MOST + 1];
};

// The eye's filters and the detectors of features, each the product of a row's and a column's.
struct kernels {
	struct kernel eye[3][2]; // the Gaussians of each opponent channel
	double share[3][2]; // of a channel's sum: those of one channel add to 1
	struct kernel smooth, edge, point; // a Gaussian and its first two derivatives
};

// What is seen of a picture at one exposure. Planes of width · height.
struct seen {
	float *lab[3]; // L*a*b*, a and b made smaller in the dark (Hunt)
	float *edge, *point; // the strength of edges and points
};

struct work {
	uint32_t width, height; // of the rows that are seen now
	struct kernels kernels;
	struct seen test, reference;
	float *plane[6]; // scratch
	float *map; // the largest FLIP of each pixel so far
	float *padded; // a row with its ends repeated
	float *block; // what all of these lie in
};

static void multiply(const double m[3][3], const double v[3], double out[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
}

static double white(int i)
{
	return to_xyz[i][0] + to_xyz[i][1] + to_xyz[i][2];
}

// YCxCz, the opponent colours in which the eye's filters work.
static void opponent_of(const double linear[3], double out[3])
{
	double xyz[3];
	multiply(to_xyz, linear, xyz);
	for (int i = 0; i < 3; i++)
		xyz[i] /= white(i);
	out[0] = 116 * xyz[1] - 16;
	out[1] = 500 * (xyz[0] - xyz[1]);
	out[2] = 200 * (xyz[1] - xyz[2]);
}

// To linear Rec.709, clipped to what a display can show.
static void linear_of(const double opponent[3], double out[3])
{
	const double y = (opponent[0] + 16) / 116;
	const double xyz[3] = {(y + opponent[1] / 500) * white(0), y * white(1), (y - opponent[2] / 200) * white(2)};
	multiply(from_xyz, xyz, out);
	for (int i = 0; i < 3; i++)
		out[i] = fmin(fmax(out[i], 0), 1);
}

static double lab_curve(double t)
{
	const double d = 6.0 / 29;
	return t > d * d * d ? cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

// L*a*b* of linear Rec.709, with Hunt's effect: colours fade with lightness.
static void lab_of(const double linear[3], double out[3])
{
	double xyz[3];
	multiply(to_xyz, linear, xyz);
	const double x = lab_curve(xyz[0] / white(0)), y = lab_curve(xyz[1] / white(1)), z = lab_curve(xyz[2] / white(2));
	out[0] = 116 * y - 16;
	out[1] = 0.01 * out[0] * 500 * (x - y);
	out[2] = 0.01 * out[0] * 200 * (y - z);
}

// HyAB: the distance of lightness and that of colour, added.
static double distance(double l, double a, double b)
{
	return fabs(l) + sqrt(a * a + b * b);
}

// The power of the distance of green from blue, the largest that a display has.
static double largest_distance(void)
{
	double green[3], blue[3];
	lab_of((const double[3]){0, 1, 0}, green);
	lab_of((const double[3]){0, 0, 1}, blue);
	return pow(distance(green[0] - blue[0], green[1] - blue[1], green[2] - blue[2]), COLOUR_EXPONENT);
}

// A Gaussian of the eye, whose taps add to 1. Returns its weight beside others of its channel.
static double make_gaussian(struct kernel *k, double a, double b)
{
	k->radius = (int)ceil(3 * sqrt(WIDEST / (2 * PI * PI)) * FLIP_PIXELS_A_DEGREE);
	double tap[2 * RADIUS_MOST + 1], sum = 0;
	for (int i = -k->radius; i <= k->radius; i++) {
		const double x = i / FLIP_PIXELS_A_DEGREE;
		sum += tap[i + k->radius] = exp(-PI * PI * x * x / b);
	}
	for (int i = 0; i <= 2 * k->radius; i++)
		k->tap[i] = (float)(tap[i] / sum);
	return a * sqrt(PI / b) * sum * sum;
}

// Scale taps so that the positive ones add to 1 and the negative ones, if any, to -1.
static void normalise(struct kernel *k, const double *tap)
{
	double positive = 0, negative = 0;
	for (int i = 0; i <= 2 * k->radius; i++) {
		positive += fmax(tap[i], 0);
		negative -= fmin(tap[i], 0);
	}
	for (int i = 0; i <= 2 * k->radius; i++)
		k->tap[i] = (float)(tap[i] > 0 ? tap[i] / positive : tap[i] < 0 ? tap[i] / negative : 0);
}

static void make_kernels(struct kernels *k)
{
	for (int c = 0; c < 3; c++) {
		const double *s = sensitivity[c];
		const double first = make_gaussian(&k->eye[c][0], s[0], s[1]),
			     second = make_gaussian(&k->eye[c][1], s[2], s[3]);
		k->share[c][0] = first / (first + second);
		k->share[c][1] = second / (first + second);
	}
	const double sd = 0.5 * FEATURE_WIDTH * FLIP_PIXELS_A_DEGREE;
	double smooth[2 * RADIUS_MOST + 1], edge[2 * RADIUS_MOST + 1], point[2 * RADIUS_MOST + 1];
	const int radius = (int)ceil(3 * sd);
	for (int i = 0; i <= 2 * radius; i++) {
		const double x = i - radius;
		smooth[i] = exp(-x * x / (2 * sd * sd));
		edge[i] = -x * smooth[i];
		point[i] = (x * x / (sd * sd) - 1) * smooth[i];
	}
	k->smooth.radius = k->edge.radius = k->point.radius = radius;
	normalise(&k->smooth, smooth);
	normalise(&k->edge, edge);
	normalise(&k->point, point);
}

static void filter_rows(const struct work *w, const float *from, const struct kernel *k, float *to)
{
	const uint32_t r = (uint32_t)k->radius;
	for (uint32_t y = 0; y < w->height; y++) {
		const float *row = from + (size_t)y * w->width;
		float *out = to + (size_t)y * w->width;
		for (uint32_t i = 0; i < r; i++) {
			w->padded[i] = row[0];
			w->padded[r + w->width + i] = row[w->width - 1];
		}
		memcpy(w->padded + r, row, w->width * sizeof *row);
		memset(out, 0, w->width * sizeof *out);
		for (uint32_t i = 0; i <= 2 * r; i++)
			for (uint32_t x = 0; x < w->width; x++)
				out[x] += k->tap[i] * w->padded[x + i];
	}
}

static void filter_columns(const struct work *w, const float *from, const struct kernel *k, float *to)
{
	for (uint32_t y = 0; y < w->height; y++) {
		float *out = to + (size_t)y * w->width;
		memset(out, 0, w->width * sizeof *out);
		for (int i = -k->radius; i <= k->radius; i++) {
			const int64_t at = (int64_t)y + i, last = (int64_t)w->height - 1;
			const float *row = from + (size_t)(at < 0 ? 0 : at > last ? last : at) * w->width;
			for (uint32_t x = 0; x < w->width; x++)
				out[x] += k->tap[i + k->radius] * row[x];
		}
	}
}

// Pixels beyond the border are as those on it. `through` is scratch.
static void filter(const struct work *w, const float *from, const struct kernel *row, const struct kernel *column,
		   float *through, float *to)
{
	filter_rows(w, from, row, through);
	filter_columns(w, through, column, to);
}

static size_t pixels_of(const struct work *w)
{
	return (size_t)w->width * w->height;
}

// The eye's filter of one opponent channel, in place.
static void filter_as_eye(const struct work *w, float *plane, int channel)
{
	float *through = w->plane[3], *first = w->plane[4], *second = w->plane[5];
	const struct kernel *k = w->kernels.eye[channel];
	const double *share = w->kernels.share[channel];
	filter(w, plane, &k[0], &k[0], through, first);
	if (share[1] > 0)
		filter(w, plane, &k[1], &k[1], through, second);
	for (size_t i = 0; i < pixels_of(w); i++)
		plane[i] = (float)share[0] * first[i] + (share[1] > 0 ? (float)share[1] * second[i] : 0);
}

// The length of a detector's answer along rows and along columns.
static void detect(const struct work *w, const float *grey, const struct kernel *detector, float *strength)
{
	float *through = w->plane[3], *down = w->plane[4];
	filter(w, grey, detector, &w->kernels.smooth, through, strength);
	filter(w, grey, &w->kernels.smooth, detector, through, down);
	for (size_t i = 0; i < pixels_of(w); i++)
		strength[i] = sqrtf(strength[i] * strength[i] + down[i] * down[i]);
}

// The ACES curve (Krzysztof Narkowicz, "ACES Filmic Tone Mapping Curve", 2015) without its exposure of 0.6, as the 2021
// paper has it: (k0 x² + k1 x) / (k3 x² + k4 x + k5).
static const double aces[5] = {0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14};

static double tone(double x)
{
	x = fmin(fmax(x, 0), 1e30);
	return fmin((aces[0] * x * x + aces[1] * x) / (aces[2] * x * x + aces[3] * x + aces[4]), 1);
}

// See rows of a picture, `rgb`, times `factor`; by the ACES curve if it is of high range.
static void see(const struct work *w, const float *rgb, bool high_range, double factor, struct seen *seen)
{
	float *const *opponent = w->plane, *grey = seen->lab[0];
	for (size_t i = 0; i < pixels_of(w); i++) {
		double linear[3], o[3];
		for (int c = 0; c < 3; c++) {
			const double value = (double)rgb[3 * i + (size_t)c];
			linear[c] = high_range ? tone(value * factor) : value;
		}
		opponent_of(linear, o);
		for (int c = 0; c < 3; c++)
			opponent[c][i] = (float)o[c];
		grey[i] = (float)((o[0] + 16) / 116);
	}
	detect(w, grey, &w->kernels.edge, seen->edge);
	detect(w, grey, &w->kernels.point, seen->point);
	for (int c = 0; c < 3; c++)
		filter_as_eye(w, opponent[c], c);
	for (size_t i = 0; i < pixels_of(w); i++) {
		const double o[3] = {(double)opponent[0][i], (double)opponent[1][i], (double)opponent[2][i]};
		double linear[3], lab[3];
		linear_of(o, linear);
		lab_of(linear, lab);
		for (int c = 0; c < 3; c++)
			seen->lab[c][i] = (float)lab[c];
	}
}

// Differences of colour up to the knee take KNEE_VALUE of the range, larger ones share the rest.
static double colour_difference(const struct seen *a, const struct seen *b, size_t i, double largest)
{
	const double knee = KNEE * largest;
	const double d = pow(distance((double)(a->lab[0][i] - b->lab[0][i]), (double)(a->lab[1][i] - b->lab[1][i]),
				      (double)(a->lab[2][i] - b->lab[2][i])),
			     COLOUR_EXPONENT);
	return d < knee ? d * KNEE_VALUE / knee : KNEE_VALUE + (d - knee) / (largest - knee) * (1 - KNEE_VALUE);
}

static double feature_difference(const struct seen *a, const struct seen *b, size_t i)
{
	const double edge = fabs((double)a->edge[i] - (double)b->edge[i]);
	const double point = fabs((double)a->point[i] - (double)b->point[i]);
	return pow(fmin(fmax(edge, point) / sqrt(2.0), 1), FEATURE_EXPONENT);
}

// Equation 1 of the 2020 paper, and the largest over exposures (2021, section 3).
static void keep_largest(struct work *w)
{
	const double largest = largest_distance();
	for (size_t i = 0; i < pixels_of(w); i++) {
		const double colour = colour_difference(&w->test, &w->reference, i, largest);
		const double feature = feature_difference(&w->test, &w->reference, i);
		w->map[i] = fmaxf(w->map[i], (float)fmin(pow(colour, 1 - feature), 1));
	}
}

static int ascending(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

// Which exposures the reference calls for (section 3.1 of the 2021 paper). The brightest and the median are of the pixels
// that count.
static enum status choose_exposures(const struct picture *b, const float *excluded, struct flip *flip, struct error *err)
{
	const size_t pixels = (size_t)b->width * b->height;
	size_t count = 0, black = 0;
	float *sorted = malloc(pixels * sizeof *sorted);
	if (!sorted)
		return error_set(err, STATUS_MEMORY, "no memory to choose exposures");
	for (size_t i = 0; i < pixels; i++) {
		const float *rgb = b->rgb + 3 * i;
		const double luminance = 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
		if (!(excluded[i] < 0))
			sorted[count++] = (float)fmax(luminance, 0);
	}
	qsort(sorted, count, sizeof *sorted, ascending);
	while (black < count && !(sorted[black] > 0))
		black++;
	if (black < count) {
		const double middle = (double)sorted[black <= count / 2 ? count / 2 : black + (count - black) / 2];
		const double t = 0.85, qa = aces[0] - t * aces[2], qb = aces[1] - t * aces[3], qc = -t * aces[4];
		const double x = (-qb + sqrt(qb * qb - 4 * qa * qc)) / (2 * qa);
		flip->exposure_low = log2(x / (double)sorted[count - 1]);
		flip->exposure_high = log2(x / middle);
		const double steps = ceil(flip->exposure_high - flip->exposure_low);
		flip->exposures = (uint32_t)fmin(fmax(steps, 2), FLIP_EXPOSURES_MOST);
	}
	free(sorted);
	return STATUS_OK;
}

// One block: two pictures as seen, scratch, the map and a padded row.
static enum status work_init(struct work *w, const struct picture *p, struct error *err)
{
	const size_t rows = p->height < BAND + 2 * RADIUS_MOST ? p->height : BAND + 2 * RADIUS_MOST, n = rows * p->width;
	*w = (struct work){.width = p->width};
	w->block = calloc(17 * n + p->width + 2 * RADIUS_MOST, sizeof *w->block);
	if (!w->block)
		return error_set(err, STATUS_MEMORY, "no memory to compare as an eye does");
	float *next = w->block;
	struct seen *const seen[2] = {&w->test, &w->reference};
	for (int k = 0; k < 2; k++) {
		for (int c = 0; c < 3; c++, next += n)
			seen[k]->lab[c] = next;
		seen[k]->edge = next;
		seen[k]->point = next + n;
		next += 2 * n;
	}
	for (int i = 0; i < 6; i++, next += n)
		w->plane[i] = next;
	w->map = next;
	w->padded = next + n;
	make_kernels(&w->kernels);
	return STATUS_OK;
}

// Compare the rows from `first` on at all exposures: w->height of them.
static void compare_rows(struct work *w, const struct picture *a, const struct picture *b, uint32_t first, bool high_range,
			 const struct flip *flip)
{
	const size_t at = 3 * (size_t)first * w->width;
	memset(w->map, 0, pixels_of(w) * sizeof *w->map);
	for (uint32_t i = 0; i < flip->exposures; i++) {
		const double step = flip->exposures > 1 ? (double)i / (flip->exposures - 1) : 0;
		const double factor = exp2(flip->exposure_low + step * (flip->exposure_high - flip->exposure_low));
		see(w, a->rgb + at, high_range, factor, &w->test);
		see(w, b->rgb + at, high_range, factor, &w->reference);
		keep_largest(w);
	}
}

enum status flip_compare(const struct picture *a, const struct picture *b, const float *excluded, bool high_range,
			 struct flip *flip, float *map, struct error *err)
{
	struct work w;
	double sum = 0;
	size_t count = 0;
	*flip = (struct flip){.exposures = 1};
	if ((high_range && choose_exposures(b, excluded, flip, err) != STATUS_OK) || work_init(&w, b, err) != STATUS_OK)
		return err->code;
	for (uint32_t band = 0; band < b->height; band += BAND) {
		const uint32_t end = b->height - band < BAND ? b->height : band + BAND;
		const uint32_t first = band < RADIUS_MOST ? 0 : band - RADIUS_MOST;
		w.height = (b->height - end < RADIUS_MOST ? b->height : end + RADIUS_MOST) - first;
		compare_rows(&w, a, b, first, high_range, flip);
		for (size_t i = (size_t)band * b->width; i < (size_t)end * b->width; i++) {
			const double value = (double)w.map[i - (size_t)first * b->width];
			if (map)
				map[i] = excluded[i] < 0 ? excluded[i] : (float)value;
			if (excluded[i] < 0)
				continue;
			sum += value;
			flip->max = fmax(flip->max, value);
			count++;
		}
	}
	flip->mean = count ? sum / (double)count : 0;
	free(w.block);
	return STATUS_OK;
}
