#include "server/scene/animation.h"

#include <math.h>
#include <string.h>

// A curve in the blob: `keys` times, followed by `values` vectors of `width` floats for each key.
struct curve {
	const float *times, *data;
	uint32_t keys;
	int width, values;
};

static struct curve curve_of(const struct scene_channel *c, const float *curves)
{
	return (struct curve){.times = curves + c->first,
			      .data = curves + c->first + c->keys,
			      .keys = c->keys,
			      .width = c->path == CHANNEL_ROTATION ? 4 : 3,
			      .values = c->curve == CURVE_CUBIC ? 3 : 1};
}

// `which` selects, in a cubic curve, 0 the incoming tangent, 1 the value, 2 the outgoing tangent. In other curves it is 0.
static const float *value_of(const struct curve *c, uint32_t key, int which)
{
	return c->data + ((size_t)key * (size_t)c->values + (size_t)which) * (size_t)c->width;
}

// The last key at or before `time`, which must lie between the first key and the last.
static uint32_t key_before(const struct curve *c, double time)
{
	uint32_t low = 0, high = c->keys - 1;
	while (high - low > 1) {
		const uint32_t middle = low + (high - low) / 2;
		if ((double)c->times[middle] <= time)
			low = middle;
		else
			high = middle;
	}
	return low;
}

static void make_unit(double q[4])
{
	const double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
	for (int i = 0; i < 4; i++)
		q[i] = length > 0 ? q[i] / length : i == 3;
}

static void slerp(const float *from, const float *to, double share, double out[4])
{
	double a[4], b[4], cosine = 0;
	for (int i = 0; i < 4; i++) {
		a[i] = (double)from[i];
		b[i] = (double)to[i];
	}
	make_unit(a);
	make_unit(b);
	for (int i = 0; i < 4; i++)
		cosine += a[i] * b[i];
	const double sign = cosine < 0 ? -1 : 1, angle = acos(fmin(fabs(cosine), 1));
	// For a small angle, linear interpolation is as accurate and avoids dividing by a small number.
	const double wa = angle < 1e-6 ? 1 - share : sin((1 - share) * angle) / sin(angle);
	const double wb = angle < 1e-6 ? share : sin(share * angle) / sin(angle);
	for (int i = 0; i < 4; i++)
		out[i] = wa * a[i] + sign * wb * b[i];
}

static void hermite(const struct curve *c, uint32_t key, double share, double span, double out[4])
{
	const float *v0 = value_of(c, key, 1), *m0 = value_of(c, key, 2), *v1 = value_of(c, key + 1, 1),
		    *m1 = value_of(c, key + 1, 0);
	const double t = share, t2 = t * t, t3 = t2 * t;
	for (int i = 0; i < c->width; i++)
		out[i] = (2 * t3 - 3 * t2 + 1) * (double)v0[i] + span * (t3 - 2 * t2 + t) * (double)m0[i] +
			 (3 * t2 - 2 * t3) * (double)v1[i] + span * (t3 - t2) * (double)m1[i];
}

static void between(const struct scene_channel *channel, const struct curve *c, double time, double out[4])
{
	const uint32_t key = key_before(c, time);
	const double start = (double)c->times[key], span = (double)c->times[key + 1] - start, share = (time - start) / span;
	const float *from = value_of(c, key, 0), *to = value_of(c, key + 1, 0);
	if (channel->curve == CURVE_CUBIC) {
		hermite(c, key, share, span, out);
	} else if (channel->curve == CURVE_LINEAR && c->width == 4) {
		slerp(from, to, share, out);
	} else {
		for (int i = 0; i < c->width; i++)
			out[i] = channel->curve == CURVE_STEP ? (double)from[i]
							      : (1 - share) * (double)from[i] + share * (double)to[i];
	}
}

void animation_sample(const struct scene_channel *channel, const float *curves, double time_s, double out[4])
{
	const struct curve c = curve_of(channel, curves);
	const bool early = time_s <= (double)c.times[0], late = time_s >= (double)c.times[c.keys - 1];
	if (early || late) {
		const float *value = value_of(&c, early ? 0 : c.keys - 1, channel->curve == CURVE_CUBIC ? 1 : 0);
		for (int i = 0; i < c.width; i++)
			out[i] = (double)value[i];
	} else {
		between(channel, &c, time_s, out);
	}
	if (c.width == 4)
		make_unit(out);
}

void animation_apply(const struct blob_header *blob, const struct scene_animation *animation, double time_s,
		     struct transform_parts *parts, uint8_t *moved)
{
	const struct scene_channel *channels = blob_section(blob, BLOB_CHANNELS);
	const float *curves = blob_section(blob, BLOB_CURVES);
	for (uint32_t i = 0; i < animation->channel_count; i++) {
		const struct scene_channel *c = &channels[animation->first_channel + i];
		struct transform_parts *p = &parts[c->node];
		double value[4];
		animation_sample(c, curves, time_s, value);
		if (c->path == CHANNEL_TRANSLATION)
			memcpy(p->translation, value, sizeof p->translation);
		else if (c->path == CHANNEL_ROTATION)
			memcpy(p->rotation, value, sizeof p->rotation);
		else
			memcpy(p->scale, value, sizeof p->scale);
		moved[c->node] |= (uint8_t)(1u << c->path);
	}
}
