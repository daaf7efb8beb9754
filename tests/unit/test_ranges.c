// The ranges of textures and of materials are those of all their texels and corners, wherever the extremes lie.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/scene/ranges.h"

#define MOST 20000u

static uint32_t texels[MOST];

static struct texture_range range_of_kind(uint32_t width, uint32_t height, uint32_t offset, uint32_t flags)
{
	const struct texture_info texture = {.offset = offset, .width = width, .height = height, .flags = flags};
	struct texture_range range;
	ranges_of_textures(&texture, 1, texels, &range);
	return range;
}

static struct texture_range range_of(uint32_t width, uint32_t height, uint32_t offset)
{
	return range_of_kind(width, height, offset, 0);
}

static void an_extreme_is_found_wherever_it_lies(void **state)
{
	static const uint32_t counts[] = {1, 2, 15, 16, 17, 31, 4095, 4096, 4097, 4112, 8200};
	(void)state;
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		for (uint32_t at = 0; at<counts[i]; at += counts[i]> 40 && at > 20 && at + 40 < counts[i] ? 97 : 1)
			for (int c = 0; c < 4; c++) {
				for (uint32_t k = 0; k < MOST; k++)
					texels[k] = k >= 5 && k < counts[i] + 5 ? 0x40506070u : (k & 1 ? 0xFFFFFFFFu : 0);
				const uint32_t plain[4] = {0x70, 0x60, 0x50, 0x40};
				texels[at + 5] += 0x11u << (8 * c);
				struct texture_range range = range_of(counts[i], 1, 5);
				assert_int_equal(range.high[c], plain[c] + 0x11);
				assert_int_equal(range.low[c], counts[i] == 1 ? plain[c] + 0x11 : plain[c]);
				texels[at + 5] -= 0x22u << (8 * c);
				range = range_of(1, counts[i], 5);
				assert_int_equal(range.low[c], plain[c] - 0x11);
				assert_int_equal(range.high[c], counts[i] == 1 ? plain[c] - 0x11 : plain[c]);
				for (int other = 0; other < 4; other++)
					if (other != c)
						assert_true(range.low[other] == plain[other] &&
							    range.high[other] == plain[other]);
			}
}

static void put_deep(uint32_t at, int c, uint16_t number)
{
	uint32_t *word = &texels[5 + 2 * at + (uint32_t)c / 2];
	*word = (*word & ~(65535u << 16 * (c % 2))) | (uint32_t)number << 16 * (c % 2);
}

// Numbers of 16 bits lie between those that 8 bits have, 257 times 0 … 255: a range takes the next one outside.
static void an_extreme_of_deep_texels_is_rounded_outwards(void **state)
{
	static const uint32_t counts[] = {1, 2, 17, 4095, 4097, 8200}, plain[4] = {0x70, 0x60, 0x50, 0x40};
	(void)state;
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
		for (uint32_t at = 0; at<counts[i]; at += counts[i]> 40 && at > 2 && at + 40 < counts[i] ? 997 : 1)
			for (int c = 0; c < 4; c++) {
				const bool lone = counts[i] == 1;
				for (uint32_t k = 0; k < MOST; k++) // around them: black and white
					texels[k] = k % 4 / 2 ? 0xFFFFFFFFu : 0;
				for (uint32_t k = 0; k < counts[i]; k++)
					for (int all = 0; all < 4; all++)
						put_deep(k, all, (uint16_t)(257 * plain[all]));
				put_deep(at, c, (uint16_t)(257 * plain[c] + 1));
				struct texture_range range = range_of_kind(counts[i], 1, 5, TEXTURE_DEEP);
				assert_int_equal(range.low[c], plain[c]);
				assert_int_equal(range.high[c], plain[c] + 1);
				put_deep(at, c, (uint16_t)(257 * plain[c] - 1));
				range = range_of_kind(1, counts[i], 5, TEXTURE_DEEP);
				assert_int_equal(range.low[c], plain[c] - 1);
				assert_int_equal(range.high[c], plain[c]);
				put_deep(at, c, (uint16_t)(257 * (plain[c] + 0x11)));
				range = range_of_kind(counts[i], 1, 5, TEXTURE_DEEP);
				assert_int_equal(range.low[c], lone ? plain[c] + 0x11 : plain[c]);
				assert_int_equal(range.high[c], plain[c] + 0x11);
				for (int other = 0; other < 4; other++)
					if (other != c)
						assert_true(range.low[other] == plain[other] &&
							    range.high[other] == plain[other]);
			}
}

static void a_whole_range_ends_the_search(void **state)
{
	(void)state;
	memset(texels, 0x80, sizeof texels);
	texels[0] = 0;
	texels[1] = 0xFFFFFFFFu;
	const struct texture_range range = range_of(MOST, 1, 0);
	for (int c = 0; c < 4; c++)
		assert_true(range.low[c] == 0 && range.high[c] == 255);
}

static void textures_of_one_image_share_its_range(void **state)
{
	const struct texture_info textures[] = {{.offset = 0, .width = 4, .height = 2},
						{.offset = 8, .width = 2, .height = 2},
						{.offset = 0, .width = 4, .height = 2}};
	struct texture_range ranges[3];
	(void)state;
	for (uint32_t i = 0; i < 12; i++)
		texels[i] = 0x01010101u * i;
	ranges_of_textures(textures, 3, texels, ranges);
	assert_memory_equal(&ranges[0], &ranges[2], sizeof ranges[0]);
	assert_true(ranges[0].low[3] == 0 && ranges[0].high[3] == 7 && ranges[1].low[0] == 8 && ranges[1].high[0] == 11);
}

static void materials_count_their_triangles_and_corners(void **state)
{
	const struct triangle triangles[] = {{{0, 1, 2}, 1}, {{2, 1, 0}, 1}, {{1, 2, 3}, 2}};
	const struct vertex_color colors[] = {{{.5f, 1, 2, 1}}, {{0, 1, 1, .25f}}, {{1, .5f, 1, 1}}, {{9, 9, 9, 9}}};
	struct material_use uses[3];
	(void)state;
	const struct vertex_tangent tangents[] = {{{0}}, {{0, 0, 0, 1}}, {{0}}, {{0, -1, 0, 1}}};
	ranges_of_materials(triangles, 3, colors, tangents, 3, uses);
	assert_true(uses[0].tangents == 0 && uses[1].tangents == 0 && uses[2].tangents == 1);
	assert_true(uses[0].triangles == 0 && uses[1].triangles == 2 && uses[2].triangles == 1);
	assert_true(uses[0].color_low[0] >= 1 && uses[0].color_high[0] <= 1);
	assert_true(uses[1].color_low[0] <= 0 && uses[1].color_high[0] <= 1 && uses[1].color_high[2] >= 2);
	assert_true(uses[1].color_low[3] <= .25f && uses[2].color_high[3] >= 9 && uses[2].color_low[1] <= .5f);
	ranges_of_materials(triangles, 3, NULL, NULL, 3, uses);
	assert_true(uses[2].tangents == 0 && uses[1].triangles == 2 && uses[1].color_low[3] >= 1 &&
		    uses[1].color_high[3] <= 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
	    cmocka_unit_test(an_extreme_is_found_wherever_it_lies),
	    cmocka_unit_test(an_extreme_of_deep_texels_is_rounded_outwards),
	    cmocka_unit_test(a_whole_range_ends_the_search),
	    cmocka_unit_test(textures_of_one_image_share_its_range),
	    cmocka_unit_test(materials_count_their_triangles_and_corners),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
