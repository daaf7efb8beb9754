"""Writes form_factor_expected.h: pairs of polygons and what they exchange, from closed forms in 50 digits. With --float it writes
form_factor_scenes.h: the same pairs as a scene has them, with the corners rounded to float, and what those exchange. Needs
python3-mpmath; run by hand where a configuration is added:

    python3 tests/unit/form_factor_expected.py > tests/unit/form_factor_expected.h
    python3 tests/unit/form_factor_expected.py --float > tests/unit/form_factor_scenes.h
    clang-format-14 -i tests/unit/form_factor_expected.h tests/unit/form_factor_scenes.h

The forms are those of Howell's catalogue of configuration factors, C-13 and C-15, and for C-16 a single integral that is derived
below. Every number is held to a quadrature by area, which shares no formula with these, in the test."""
import itertools
import struct
import sys

from mpmath import atan, atan2, cos, hypot, inf, log, mp, mpf, pi, quad, sin, sqrt

mp.dps = 50
FLOATS = sys.argv[1:] == ["--float"]


def stored(number):
    """A coordinate as it is stored."""
    return mpf(struct.unpack("f", struct.pack("f", float(number)))[0]) if FLOATS else mpf(number)


def over_corners(corner, *ranges):
    """Σ ± corner(…) over the ends of all ranges: + at upper ends."""
    total = mpf(0)
    for ends in itertools.product((0, 1), repeat=len(ranges)):
        total += (-1) ** (len(ranges) - sum(ends)) * corner(*(mpf(r[e]) for r, e in zip(ranges, ends)))
    return total


def parallel(x, y, u, v, gap):
    """C-13: rectangles x × y and u × v in planes that face each other."""
    z = mpf(gap)

    def corner(x, y, u, v):
        p, q = x - u, y - v
        a, b = sqrt(p * p + z * z), sqrt(q * q + z * z)
        return (q * a * atan(q / a) + p * b * atan(p / b) - z * z / 2 * log(p * p + q * q + z * z)) / (2 * pi)
    return over_corners(corner, x, y, u, v)


def perpendicular(x, y, z, v):
    """C-15: rectangle x × y in the plane z = 0, and z × v in the plane x = 0, x and z ≥ 0, y and v along the same axis."""
    def corner(x, y, z, v):
        c, q = x * x + z * z, y - v
        if c == 0:
            return q * q / 4 * log(q * q) / (2 * pi) if q else mpf(0)
        k = q / sqrt(c)
        return (q * sqrt(c) * atan(k) - (c - q * q) / 4 * log(c + q * q)) / (2 * pi)
    return over_corners(corner, x, y, z, v)


def hinged(a, b, c, phi):
    """C-16: rectangles a × c and b × c with the edge c in common. Strips at x and z of them, ρ apart, exchange
    x z sin² φ · c atan(c / ρ) / (π ρ³) dx dz; in polar coordinates x = r cos ψ, z = r sin ψ that is elementary along r."""
    def ray(psi):
        g = sqrt(1 - 2 * sin(psi) * cos(psi) * cos(phi))
        end, k = min(a / cos(psi) if cos(psi) else inf, b / sin(psi) if psi else inf), c / g
        return sin(psi) * cos(psi) / g ** 3 * (end * atan(k / end) + k / 2 * log(1 + (end / k) ** 2))
    corner = atan(b / a)
    spots = sorted({mpf(0), corner, pi / 4, pi / 2} | {pi / 4 + s * phi * t for s in (-1, 1) for t in (mpf(1) / 4, mpf(1) / 2)
                                                        if phi < pi / 2})
    return c * sin(phi) ** 2 / pi * quad(ray, spots)


def rectangle(at, u, v):
    at, u, v = ([mpf(c) for c in vector] for vector in (at, u, v))
    return [at, [p + q for p, q in zip(at, u)], [p + q + r for p, q, r in zip(at, u, v)], [p + r for p, r in zip(at, v)]]


def span(ends):
    return stored(ends[0]), stored(ends[1])


def facing(name, x, y, u, v, gap):
    x, y, u, v = (span(ends) for ends in (x, y, u, v))
    gap = stored(gap)
    floor = rectangle((x[0], y[0], 0), (x[1] - x[0], 0, 0), (0, y[1] - y[0], 0))
    lid = rectangle((u[0], v[0], gap), (0, v[1] - v[0], 0), (u[1] - u[0], 0, 0))
    return name, floor, lid, parallel(x, y, u, v, gap)


def upright(name, x, y, z, v, seen=None):
    """`seen`: what of the rectangles the other's plane leaves, where it does not leave all."""
    x, y, z, v = (span(ends) for ends in (x, y, z, v))
    floor = rectangle((x[0], y[0], 0), (x[1] - x[0], 0, 0), (0, y[1] - y[0], 0))
    wall = rectangle((0, v[0], z[0]), (0, v[1] - v[0], 0), (0, 0, z[1] - z[0]))
    return name, floor, wall, perpendicular(*([span(ends) for ends in seen] if seen else (x, y, z, v)))


def hinge(name, a, b, c, degrees):
    a, b, c, phi = stored(a), mpf(b), stored(c), mpf(degrees) * pi / 180
    x, z = stored(b * cos(phi)), stored(b * sin(phi))
    floor = rectangle((0, 0, 0), (a, 0, 0), (0, c, 0))
    flap = rectangle((0, 0, 0), (0, c, 0), (x, 0, z))
    return name, floor, flap, hinged(a, hypot(x, z), c, atan2(z, x))


one, tiny = (0, 1), (0, mpf("1e-6"))
far, near = (10000, 10001), (1, 2)


def configurations():
    yield facing("squares face each other", one, one, one, one, 1)
    yield facing("squares a tenth apart", one, one, one, one, "0.1")
    yield facing("squares ten apart", one, one, one, one, 10)
    yield facing("squares a millionth apart", one, one, one, one, "1e-6")
    yield facing("squares 10^4 apart", one, one, one, one, 10000)
    yield facing("rectangles of two shapes", (0, 3), (0, "0.5"), (1, 2), (-1, 2), "0.7")
    yield facing("squares that do not overlap", one, one, near, one, "0.25")
    yield facing("squares that meet at a corner from above", one, one, near, near, "0.25")
    yield facing("squares offset by ten", one, one, (10, 11), (3, 4), 1)
    yield facing("beside each other, a thousandth apart in height", one, one, near, one, "1e-3")
    yield facing("a square away, a millionth apart in height", one, one, (2, 3), one, "1e-6")
    yield facing("10^4 sizes away, one apart in height", one, one, far, one, 1)
    yield facing("10^4 sizes away and grazing", one, one, far, far, "0.1")
    yield facing("a tiny square above a huge one", one, one, (-10000, 10000), (-10000, 10000), "0.5")
    yield facing("a tiny square close above a huge one", tiny, tiny, (-1, 1), (-1, 1), "1e-6")
    yield facing("a tiny square beyond a huge one's edge", tiny, tiny, (1, 2), (-1, 1), "0.01")
    yield facing("needles over each other, a width apart", one, tiny, one, tiny, "1e-6")
    yield facing("needles over each other, 1000 widths apart", one, tiny, one, tiny, "1e-3")
    yield facing("needles over each other, a length apart", one, tiny, one, tiny, 1)
    yield facing("needles that cross", one, tiny, tiny, one, "1e-3")
    yield facing("a needle over a square", one, tiny, one, one, "0.1")
    yield facing("needles side by side, grazing", one, tiny, one, ("0.01", mpf("0.01") + tiny[1]), "1e-3")
    yield facing("strips of a long channel", (0, 10000), one, (0, 10000), one, 1)
    yield upright("squares share an edge", one, one, one, one)
    yield upright("rectangles share an edge", (0, 2), one, (0, "0.3"), one)
    yield upright("rectangles share a part of an edge", one, one, one, ("0.25", 3))
    yield upright("squares share a corner", one, one, one, (1, 2))
    yield upright("squares at right angles apart", ("0.5", 1), one, ("0.25", 2), (2, 3))
    yield upright("squares at right angles, an edge across", (1, 2), one, one, one)
    yield upright("squares at right angles, 10^4 sizes away", far, one, one, one)
    yield upright("squares at right angles, 10^4 along the edge", one, one, one, far)
    yield upright("needles share their long edge", tiny, one, tiny, one)
    yield upright("needles share their short edge", one, tiny, one, tiny)
    yield upright("needles meet at a corner", tiny, one, tiny, (1, 2))
    yield upright("a needle stands on a square's edge", one, one, one, tiny)
    yield upright("a needle lies along a square's edge", one, one, tiny, one)
    yield upright("a tiny square on a huge one's edge", (0, 10000), (-5000, 5000), one, one)
    yield upright("a tiny square near a huge one's corner", (0, 10000), (0, 10000), one, ("-0.5", "0.5"))
    yield upright("half of the wall is below the floor", one, one, (-1, 1), one, (one, one, one, one))
    yield upright("half of the floor is behind the wall", (-1, 1), one, one, one, (one, one, one, one))
    yield upright("each is half behind the other", (-1, 1), one, (-3, 1), (0, 2), (one, one, one, (0, 2)))
    yield upright("a sliver of the wall is above the floor", one, one, (-1, "1e-4"), one, (one, one, (0, "1e-4"), one))
    for degrees in (1, 5, 15, 30, 45, 60, 90, 120, 135, 150, 165, 175, 179):
        yield hinge(f"squares at {degrees} degrees", 1, 1, 1, degrees)
    for degrees in (1, 60, 120, 179):
        yield hinge(f"rectangles at {degrees} degrees", mpf("0.25"), 2, 1, degrees)
    for degrees in (1, 90, 179):
        yield hinge(f"needles at {degrees} degrees", tiny[1], tiny[1], 1, degrees)


def numbers(corners):
    return ", ".join("{" + ", ".join(repr(float(c)) for c in corner) + "}" for corner in corners)


def main():
    array = "expected_of_floats" if FLOATS else "expected"
    print(f"// Written by form_factor_expected.py: pairs of polygons{', rounded to float,' if FLOATS else ','} and what they exchange in m².")
    guard = f"CANDIL_TESTS_FORM_FACTOR_{'SCENES' if FLOATS else 'EXPECTED'}_H"
    print(f"#ifndef {guard}\n#define {guard}\n")
    if FLOATS:
        print('#include "tests/unit/form_factor_expected.h"\n')
    else:
        print('#include "server/worker/technique/radiosity/form_factor.h"\n')
        print("struct expected {\n\tconst char *name;\n\tstruct form_polygon a, b;\n\tdouble exchange;\n};\n")
    print(f"static const struct expected {array}[] = {{")
    for name, a, b, exchange in configurations():
        print(f'    {{"{name}", {{{{{numbers(a)}}}, 4}}, {{{{{numbers(b)}}}, 4}}, {mp.nstr(exchange, 17)}}},')
    print("};\n\n#endif")


if __name__ == "__main__":
    main()
