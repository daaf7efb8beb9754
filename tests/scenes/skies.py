"""Pictures of all directions for tests and people, as arrays height x width x 3, row 0 at the top.

    skies.py FILE.exr [WIDTH]    write a sunset sky

A texel's middle is at longitude (x + 0.5) / width - 0.5 turns, 0 along -Z and a quarter along +X, and at latitude
90 - 180 (y + 0.5) / height degrees.
"""
import sys

import numpy as np


def directions(width, height):
    """The unit vectors of the texels' middles."""
    longitude = (np.arange(width) + 0.5) / width * 2 * np.pi - np.pi
    polar = (np.arange(height) + 0.5) / height * np.pi
    across = np.sin(polar)[:, None]
    return np.stack([across * np.sin(longitude), np.cos(polar)[:, None] * np.ones(width), -across * np.cos(longitude)], axis=2)


def solid_angles(width, height):
    """Of the texels of each row, sr."""
    edges = np.cos(np.linspace(0, np.pi, height + 1))
    return (edges[:-1] - edges[1:]) * 2 * np.pi / width


def even(width, height, radiance=1.0):
    return np.full((height, width, 3), radiance)


def spot(width, height, column, row, radiance):
    """One bright texel in the dark."""
    sky = np.zeros((height, width, 3))
    sky[row, column] = radiance
    return sky


def finer(sky, times):
    """The same sky by the rule of its lookups, bilinear across the seam and flat towards the poles, in finer texels."""
    def along(a, axis, wraps):
        count = a.shape[axis]
        at = (np.arange(count * times) + 0.5) / times - 0.5
        low = np.floor(at).astype(int)
        part = (at - low).reshape([-1 if i == axis else 1 for i in range(3)])
        pick = (lambda i: i % count) if wraps else (lambda i: np.clip(i, 0, count - 1))
        return np.take(a, pick(low), axis) * (1 - part) + np.take(a, pick(low + 1), axis) * part
    return along(along(sky, 1, True), 0, False)


def irradiance(sky, normal, times=8):
    """W/m2 on a plane that sees nothing but the sky, by fine quadrature."""
    fine = finer(sky, times)
    height, width, _ = fine.shape
    cosine = np.maximum(directions(width, height) @ np.asarray(normal, float), 0)
    return (fine * (cosine * solid_angles(width, height)[:, None])[:, :, None]).sum(axis=(0, 1))


def sunset(width=1024, sun=2e4):
    """A low sun in haze over a dark ground, lit clouds on the other side; the sun in the direction of +X and a little -Z."""
    height = width // 2
    w = directions(width, height)
    up = w[:, :, 1]
    towards = np.array([0.93, 0.13, -0.34])
    towards /= np.linalg.norm(towards)
    near = w @ towards
    zenith, horizon, glow = np.array([0.10, 0.19, 0.42]), np.array([0.95, 0.45, 0.20]), np.array([1.6, 0.75, 0.28])
    fade = np.exp(-np.maximum(up, 0) * 4)[:, :, None]
    sky = zenith * (1 - fade) + horizon * fade * (0.55 + 0.45 * near[:, :, None])
    sky += glow * (np.exp((near - 1) * 18) * 1.2)[:, :, None]
    clouds = np.sin(w[:, :, 0] * 9 + np.sin(w[:, :, 2] * 7) * 2) * np.sin(up * 31 + w[:, :, 0] * 3)
    sky += (np.array([0.5, 0.25, 0.2]) * (np.clip(clouds - 0.3, 0, 1) * np.exp(-up * 3))[:, :, None])
    sky = np.where((up < 0)[:, :, None], np.array([0.06, 0.05, 0.045]) * (0.6 + 0.4 * near[:, :, None]), sky)
    disc = np.cos(np.radians(0.53 / 2 * max(1.0, 360 / width / 0.53)))
    return np.where((near > disc)[:, :, None], np.array([sun, sun * 0.62, sun * 0.3]), np.maximum(sky, 0))


if __name__ == "__main__":
    import images
    images.write(sys.argv[1], sunset(int(sys.argv[2]) if len(sys.argv) > 2 else 1024))
