// Textures in storage buffers. Wrap and filter are done here, because some devices cannot index samplers dynamically.
// Filtering is done in linear light. Only the finest level is read: there are no mip maps.
#ifndef COMMON_TEXTURE_GLSL
#define COMMON_TEXTURE_GLSL

#include "common/scene.glsl"

// Where textures are. A program that has them elsewhere defines all three.
#ifndef TEXTURE_INFO
#define TEXTURE_INFO(i) textures[i]
#define TEXEL_WORD(i) texels[i]
#define SRGB_VALUE(i) srgb_table[i]
#endif

// The texel that index `i` of a side of `n` texels wraps to, by a wrap mode of layout.h.
int wrap_index(int i, int n, uint mode)
{
	if (mode == WRAP_CLAMP)
		return clamp(i, 0, n - 1);
	int period = mode == WRAP_MIRROR ? 2 * n : n;
	// The remainder of a negative number is undefined. −1 − i counts backwards from the end of the period.
	int m = (i < 0 ? -1 - i : i) % period;
	m = i < 0 ? period - 1 - m : m;
	return m < n ? m : period - 1 - m;
}

// The channels of a deep texture's texel `i`.
vec4 fetch_deep(texture_info info, uint i)
{
	uvec2 bits = uvec2(TEXEL_WORD(info.offset + 2u * i), TEXEL_WORD(info.offset + 2u * i + 1u));
	vec4 c = vec4(unpackUnorm2x16(bits.x), unpackUnorm2x16(bits.y));
	if ((info.flags & TEXTURE_SRGB) != 0u)
		c.rgb = vec3(SRGB_VALUE(256u + (bits.x & 65535u)), SRGB_VALUE(256u + (bits.x >> 16)),
			     SRGB_VALUE(256u + (bits.y & 65535u)));
	return c;
}

vec4 fetch_texel(texture_info info, int x, int y)
{
	int u = wrap_index(x, int(info.width), info.flags >> TEXTURE_WRAP_S_SHIFT & 3u);
	int v = wrap_index(y, int(info.height), info.flags >> TEXTURE_WRAP_T_SHIFT & 3u);
	uint i = uint(v) * info.width + uint(u);
	if (DEEP_TEXTURES && (info.flags & TEXTURE_DEEP) != 0u)
		return fetch_deep(info, i);
	uint bits = TEXEL_WORD(info.offset + i);
	vec4 c = unpackUnorm4x8(bits);
	if ((info.flags & TEXTURE_SRGB) != 0u)
		c.rgb = vec3(SRGB_VALUE(bits & 255u), SRGB_VALUE(bits >> 8 & 255u), SRGB_VALUE(bits >> 16 & 255u));
	return c;
}

// A program that averages many points needs no filtering: it defines this as true.
#ifndef TEXTURE_UNFILTERED
#define TEXTURE_UNFILTERED false
#endif

// `uv` holds both sets of texture coordinates, in xy and zw.
vec4 sample_texture(uint index, vec4 uv)
{
	texture_info info = TEXTURE_INFO(index);
	vec3 set = vec3((info.flags & TEXTURE_UV1) != 0u ? uv.zw : uv.xy, 1.0);
	vec2 place = vec2(dot(to_vec3(info.row_u), set), dot(to_vec3(info.row_v), set));
	vec2 size = vec2(info.width, info.height);
	// Coordinates are held to a range that an int can take. Those beyond it have lost their fraction anyway. Written as
	// comparisons that a NaN fails: a transform of huge numbers may subtract infinities.
	vec2 at = place * size;
	at = vec2(at.x > -1e9 ? min(at.x, 1e9) : -1e9, at.y > -1e9 ? min(at.y, 1e9) : -1e9);
	if (TEXTURE_UNFILTERED || (info.flags & TEXTURE_NEAREST) != 0u) {
		ivec2 t = ivec2(floor(at));
		return fetch_texel(info, t.x, t.y);
	}
	at -= 0.5;
	vec2 base = floor(at);
	vec2 f = at - base;
	ivec2 t = ivec2(base);
	vec4 top = mix(fetch_texel(info, t.x, t.y), fetch_texel(info, t.x + 1, t.y), f.x);
	vec4 bottom = mix(fetch_texel(info, t.x, t.y + 1), fetch_texel(info, t.x + 1, t.y + 1), f.x);
	return mix(top, bottom, f.y);
}

// Both sets of texture coordinates at a point of a triangle, in xy and zw.
vec4 coordinates_at(triangle tri, vec3 bary)
{
	vec4 uv = vec4(0.0);
	for (uint i = 0u; i < 3u; i++) {
		vertex v = vertices[tri.vertex[i]];
		uv.xy += bary[i] * vec2(v.uv[0], v.uv[1]);
		if (job.has_uv1 != 0u)
			uv.zw += bary[i] * vec2(uv1[tri.vertex[i]].uv[0], uv1[tri.vertex[i]].uv[1]);
	}
	return uv;
}

// Base colour and alpha: factor × texture × vertex colour, each if its effect runs.
vec4 base_color_at(material m, triangle tri, vec3 bary, vec4 uv)
{
	vec4 base = vec4(to_vec3(m.albedo), 1.0);
	if (EFFECT_TEXTURES && m.albedo_texture != NONE)
		base *= sample_texture(m.albedo_texture, uv);
	// The effect may be forced on a scene without colours, whose buffer is empty.
	if (EFFECT_VERTEX_COLORS && job.has_colors != 0u) {
		vec4 c = vec4(0.0);
		for (uint i = 0u; i < 3u; i++) {
			vertex_color k = colors[tri.vertex[i]];
			c += bary[i] * vec4(k.rgba[0], k.rgba[1], k.rgba[2], k.rgba[3]);
		}
		base *= c;
	}
	return base;
}

// The coverage of a surface at a point: 0 or 1 if it is masked, its alpha if it is blended, else 1.
float coverage_at(material m, triangle tri, vec3 bary, vec4 uv)
{
	bool masked = EFFECT_ALPHA_MASK && (m.flags & MATERIAL_ALPHA_MASK) != 0u;
	bool blended = EFFECT_ALPHA_BLEND && (m.flags & MATERIAL_ALPHA_BLEND) != 0u;
	if (!masked && !blended)
		return 1.0;
	float a = base_color_at(m, tri, bary, uv).a;
	return masked ? (a >= m.alpha_cutoff ? 1.0 : 0.0) : a * m.alpha;
}

#endif
