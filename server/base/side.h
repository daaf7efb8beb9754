// Sides of pictures that need the same shader code. A software driver compiles code anew for textures whose sides are powers
// of two where those before were none, or the other way round (worker/gl/texture.c); and some textures are half as large as
// the picture, rounded up. Any thread.
#ifndef CANDIL_BASE_SIDE_H
#define CANDIL_BASE_SIDE_H

#include <stdint.h>

// What the code for pictures with a side of `n` > 0 pixels depends on: is this number, and is half of it, a power of two?
static inline unsigned side_code(uint32_t n)
{
	return (unsigned)((n & (n - 1)) == 0) << 1 | ((n & (n + 1)) == 0);
}

// A side of about `wanted` > 0 pixels, at most `side`, that needs the code that `side` does: a smaller one than wanted if
// there is one.
static inline uint32_t side_near(uint32_t wanted, uint32_t side)
{
	uint32_t n = wanted < side ? wanted : side;
	while (n > 0 && side_code(n) != side_code(side))
		n--;
	for (n = n > 0 ? n : wanted; side_code(n) != side_code(side); n++)
		;
	return n;
}

#endif
