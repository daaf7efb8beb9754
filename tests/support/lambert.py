"""Light of polygons in closed form."""
import math

import numpy


def lambert(polygon, normal):
    """Irradiance at zero per radiance of a polygon: half the sum over its edges of the arcs that they subtend."""
    polygon, normal = [numpy.array(p, float) for p in polygon], numpy.array(normal, float)
    above = []
    for a, b in zip(polygon, polygon[1:] + polygon[:1]):
        if a @ normal >= 0:
            above.append(a)
        if (a @ normal) * (b @ normal) < 0:
            above.append(a + (b - a) * (a @ normal) / (a @ normal - b @ normal))
    total = 0
    for a, b in zip(above, above[1:] + above[:1]):
        c = numpy.cross(a, b)
        if numpy.linalg.norm(c) > 0:
            total += math.atan2(numpy.linalg.norm(c), a @ b) * (c @ normal) / numpy.linalg.norm(c)
    return abs(total) / 2
