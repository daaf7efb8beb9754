// Textures as texel buffers, for common/texture.glsl: to be included before it.
#ifndef RADIOSITY_TEXELS_GLSL
#define RADIOSITY_TEXELS_GLSL

#include "shared/layout.h"
#include "shared/radiosity_show.h"

layout(binding = RADIOSITY_TEXTURES_UNIT) uniform usamplerBuffer texture_words;
layout(binding = RADIOSITY_TEXELS_UNIT) uniform usamplerBuffer texel_words;
layout(binding = RADIOSITY_SRGB_UNIT) uniform samplerBuffer srgb_values;

texture_info texture_fetch(uint i)
{
	int at = int(i) * RADIOSITY_TEXTURE_WORDS;
	uint w[RADIOSITY_TEXTURE_WORDS];
	for (int k = 0; k < RADIOSITY_TEXTURE_WORDS; k++)
		w[k] = texelFetch(texture_words, at + k).x;
	return texture_info(w[0], w[1], w[2], w[3],
			    float[3](uintBitsToFloat(w[4]), uintBitsToFloat(w[5]), uintBitsToFloat(w[6])),
			    float[3](uintBitsToFloat(w[7]), uintBitsToFloat(w[8]), uintBitsToFloat(w[9])));
}

#define TEXTURE_INFO(i) texture_fetch(i)
#define TEXEL_WORD(i) texelFetch(texel_words, int(i)).x
#define SRGB_VALUE(i) texelFetch(srgb_values, int(i)).x

#endif
