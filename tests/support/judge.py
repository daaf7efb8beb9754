"""How far a picture without noise is from what it stands for: a path-traced one of as many scattering events.

The bar to pass is what anyone can have for nothing: direct light, and a constant times the albedo, the constant fitted to the very
reference (one number over all channels, least squares of the relative error)."""
import numpy


def relmse(picture, reference, mask):
    r = reference[mask].astype(numpy.float64)
    return float(((picture[mask] - r) ** 2 / (r * r + 0.01)).mean())


def mean_error(picture, reference, mask):
    """Relative error of the mean."""
    return float(picture[mask].mean(dtype=numpy.float64) / reference[mask].mean(dtype=numpy.float64) - 1)


def fitted(direct, albedo, reference, mask):
    """direct + k * albedo with the k of least relMSE."""
    d, a, r = (x[mask].astype(numpy.float64) for x in (direct, albedo, reference))
    weight = 1 / (r * r + 0.01)
    k = max((weight * a * (r - d)).sum() / (weight * a * a).sum(), 0)
    return (direct + k * albedo).astype(numpy.float64), k


def albedo(picture):
    """Of a picture with --aov albedo."""
    return numpy.stack([picture.channels["albedo." + c] for c in "RGB"], axis=2)


def reflecting(picture):
    """Pixels of surfaces that do not emit, of a picture with --aov albedo,id: where `direct` of nothing but emission is dark."""
    return numpy.isfinite(picture.radiance).all(axis=2) & (picture.channels["id"] > 0)
