// Camera rays of a pinhole, a thin lens or a panorama, and the position of samples in and around the pixel.
//
// A thin lens focuses all rays that leave one point of the plane of focus to one point of the image (Cook, Porter and
// Carpenter 1984; Pharr, Jakob and Humphreys, 6.2.3). So the ray from a point of the lens goes to where the pinhole's ray
// meets that plane. A point at distance z has a circle of confusion of diameter 2 R |z − f| / z on the plane of focus, seen
// from the lens's middle; R is the lens's radius and f the distance in focus.
//
// Filters are importance-sampled, not weighted: samples are placed with the filter's density, so all count equally, and the
// samples of one request can be merged with those of the next (Ernst, Stamminger and Greiner 2006, "Filter importance
// sampling").
#ifndef PATH_LENS_GLSL
#define PATH_LENS_GLSL

#include "common/camera.glsl"
#include "common/sampling.glsl"
#include "shared/pt.h"

layout(constant_id = SPEC_CAMERA) const uint CAMERA = CAMERA_PINHOLE;
layout(constant_id = SPEC_FILTER) const uint FILTER = FILTER_BOX;

// Radius at which the Gaussian and the window are cut off, and the Gaussian's standard deviation, in pixels.
const float FILTER_RADIUS = 2.0;
const float FILTER_SIGMA = 0.5;

// A distance from the pixel's middle, -FILTER_RADIUS to FILTER_RADIUS, with the density of the four-term Blackman-Harris
// window (Harris 1978). With t the distance divided by the radius, the window's integral from the middle is, up to a
// factor,
//     G(t) = t + Σ a_n / (n π a_0) sin nπt.
// G is concave, so Newton's steps from below never pass the root of G(t) = v.
float sample_window(float u)
{
	float v = abs(2.0 * u - 1.0);
	float t = 0.35875 * v;
	for (uint i = 0u; i < 8u; i++) {
		float s1 = sin(PI * t);
		float c1 = cos(PI * t);
		float s2 = 2.0 * s1 * c1;
		float c2 = 2.0 * c1 * c1 - 1.0;
		float s3 = s1 * c2 + c1 * s2;
		float c3 = c1 * c2 - s1 * s2;
		float area = 0.35875 * t + (0.48829 * s1 + 0.14128 / 2.0 * s2 + 0.01168 / 3.0 * s3) / PI;
		float window = 0.35875 + 0.48829 * c1 + 0.14128 * c2 + 0.01168 * c3;
		t += (0.35875 * v - area) / max(window, 6e-5);
	}
	return (u < 0.5 ? -1.0 : 1.0) * FILTER_RADIUS * clamp(t, 0.0, 1.0);
}

// The position of a sample, in pixels from the pixel's corner.
vec2 sample_filter(vec2 u)
{
	if (FILTER == FILTER_BLACKMAN_HARRIS)
		return 0.5 + vec2(sample_window(u.x), sample_window(u.y));
	if (FILTER == FILTER_GAUSSIAN) {
		// Box and Muller's method, cut off at the radius.
		float tail = exp(-0.5 * FILTER_RADIUS * FILTER_RADIUS / (FILTER_SIGMA * FILTER_SIGMA));
		float r = FILTER_SIGMA * sqrt(max(-2.0 * log(1.0 - u.x * (1.0 - tail)), 0.0));
		return 0.5 + r * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
	}
	return u;
}

// The direction at a point of a panorama. Longitude runs from left to right, latitude from the camera's up downwards; the
// camera's target is in the middle.
vec3 panorama_direction(vec2 at)
{
	float longitude = 2.0 * PI * (at.x / float(job.width) - 0.5);
	float latitude = PI * clamp(0.5 - at.y / float(job.height), -0.5, 0.5);
	vec3 level = sin(longitude) * to_vec3(job.right) + cos(longitude) * to_vec3(job.forward);
	return normalize(cos(latitude) * level + sin(latitude) * to_vec3(job.up));
}

// The camera ray through the point `at`, in pixels from the image's top left corner. u is uniform over the lens.
void lens_ray(vec2 at, vec2 u, out vec3 origin, out vec3 direction)
{
	if (CAMERA == CAMERA_PANORAMA) {
		origin = to_vec3(job.eye);
		direction = panorama_direction(at);
		return;
	}
	camera_ray(at, origin, direction);
	if (CAMERA == CAMERA_LENS) {
		vec2 p = concentric_disc(u);
		vec3 aside = p.x * to_vec3(job.lens_right) + p.y * to_vec3(job.lens_up);
		float along = job.focus / dot(direction, to_vec3(job.forward));
		direction = normalize(along * direction - aside);
		origin += aside;
	}
}

// Solid angle of a pixel about a ray's direction; for parallel rays, its area.
float pixel_measure(vec3 direction)
{
	if (CAMERA == CAMERA_PANORAMA) {
		float up = dot(direction, to_vec3(job.up));
		return 2.0 * PI * PI / (float(job.width) * float(job.height)) * sqrt(max(1.0 - up * up, 0.0));
	}
	float area = 4.0 * length(to_vec3(job.right)) * length(to_vec3(job.up)) / (float(job.width) * float(job.height));
	float along = max(dot(direction, to_vec3(job.forward)), 0.0);
	return job.orthographic != 0.0 ? area * along : area * along * along * along;
}

// Number of pixels that a square metre of a surface covers; the ray hits the surface at distance t with this cosine.
float pixels_per_area(vec3 direction, float t, float cosine)
{
	float reach = job.orthographic != 0.0 && CAMERA != CAMERA_PANORAMA ? 1.0 : t * t;
	return cosine / max(reach * pixel_measure(direction), 1e-37);
}

// The inverse of lens_ray: where in the image, in pixels, a point is seen through the point u of the lens, and the ray that
// shows it, with its length t. False if the point is behind the camera, or further beside the image than filters reach.
bool lens_image(vec3 point, vec2 u, out vec2 at, out vec3 origin, out vec3 direction, out float t)
{
	vec3 forward = to_vec3(job.forward);
	vec3 right = to_vec3(job.right);
	vec3 up = to_vec3(job.up);
	vec2 size = vec2(job.width, job.height);
	vec3 aside = vec3(0.0);
	if (CAMERA == CAMERA_LENS) {
		vec2 p = concentric_disc(u);
		aside = p.x * to_vec3(job.lens_right) + p.y * to_vec3(job.lens_up);
	}
	origin = to_vec3(job.eye) + aside;
	vec3 way = point - origin;
	t = length(way);
	direction = way / max(t, 1e-37);
	if (CAMERA == CAMERA_PANORAMA) {
		vec2 level = vec2(dot(direction, right), dot(direction, forward));
		float longitude = level != vec2(0.0) ? atan(level.x, level.y) : 0.0;
		float latitude = asin(clamp(dot(direction, up), -1.0, 1.0));
		at = size * vec2(0.5 + longitude / (2.0 * PI), 0.5 - latitude / PI);
		return t > 0.0;
	}
	float along = dot(way, forward);
	vec3 seen;   // in the plane at distance 1; for parallel rays, in the plane of the eye
	if (job.orthographic != 0.0) {
		direction = CAMERA == CAMERA_LENS ? normalize(job.focus * forward - aside) : forward;
		t = along / dot(direction, forward);
		origin = point - t * direction;
		seen = origin - to_vec3(job.eye) - aside;
	} else {
		// The image shows the point where the ray crosses the plane of focus.
		seen = CAMERA == CAMERA_LENS ? way / along + aside / job.focus : way / along;
	}
	at = size * vec2(0.5 + 0.5 * dot(seen, right) / dot(right, right), 0.5 - 0.5 * dot(seen, up) / dot(up, up));
	// Just before the plane of the eye, positions leave the range of an int. A NaN fails the comparison.
	bool beside = all(lessThan(abs(at - 0.5 * size), 0.5 * size + 2.0 * FILTER_RADIUS));
	return along > 0.0 && t > 0.0 && beside;
}

// Density of sample_filter over the image, 1/pixel². `from` is in pixels from the pixel's middle.
float filter_density(vec2 from)
{
	if (FILTER == FILTER_BLACKMAN_HARRIS) {
		vec2 t = from / FILTER_RADIUS;
		vec2 window = 0.35875 + 0.48829 * cos(PI * t) + 0.14128 * cos(2.0 * PI * t) + 0.01168 * cos(3.0 * PI * t);
		vec2 density = window / (2.0 * FILTER_RADIUS * 0.35875);
		return max(abs(t.x), abs(t.y)) < 1.0 ? density.x * density.y : 0.0;
	}
	if (FILTER == FILTER_GAUSSIAN) {
		float variance = FILTER_SIGMA * FILTER_SIGMA;
		float whole = 2.0 * PI * variance * (1.0 - exp(-0.5 * FILTER_RADIUS * FILTER_RADIUS / variance));
		float r2 = dot(from, from);
		return r2 < FILTER_RADIUS * FILTER_RADIUS ? exp(-0.5 * r2 / variance) / whole : 0.0;
	}
	return max(abs(from.x), abs(from.y)) <= 0.5 ? 1.0 : 0.0;
}

#endif
