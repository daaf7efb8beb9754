"""The sky's light through openings, by rays that look up the voxels (`vct.gather=rays`)."""
import os
import unittest

import numpy

import images
import openings
import rooms
import skies
from common import WHITE, VctDaemon
from table import HardCase
from writers import Gltf, quad

daemon = VctDaemon()
SIDE = 32


def setUpModule():
    unittest.enterModuleContext(daemon)


def rays(scene, resolution=64, size=(SIDE, SIDE), **options):
    return daemon.vct(scene, resolution, size, gather="rays", render=options.pop("render", daemon.twice), **options)


def error(picture, expected):
    return float(numpy.mean((picture.radiance.mean(axis=2, dtype=numpy.float64) / expected - 1) ** 2))


class Wells(HardCase):
    def test_black_walls(self):
        """What arrives is the sky's radiance times the form factor of the opening, at every depth."""
        for depth in (.25, .5, 1, 2, 4):
            with self.subTest(depth=depth):
                expected = .5 * openings.seen_from_floor(depth, SIDE)
                picture = rays(openings.well(daemon.folder, depth), rays=64, arguments=WHITE)
                self.row("sky", f"the floor of a black well of 1 x 1 x {depth:g} m", picture, picture.mean() / expected.mean(), 1,
                         "albedo × form factor, Howell B-4; in a corner a voxel mixes floor and wall", .03)

    def test_furnace(self):
        """Everything sends as much as the sky, after bounces without end; three lack the fourth power of the albedo."""
        for depth in (.5, 2):
            with self.subTest(depth=depth):
                scene = openings.well(daemon.folder, depth, walls=.2, floor=.2, emission=.8)
                picture = rays(scene, emitters="cones", bounces=3, arguments=WHITE)
                self.row("sky", f"the floor of a well {depth:g} m deep, as bright as the sky", picture, picture.mean(), 1, "conservation", .01)

    def test_the_error_falls_with_rays(self):
        """As by low-discrepancy points: at least as that of independent ones, whose mean square falls as 1 / rays."""
        expected = .5 * openings.seen_from_floor(2, SIDE)
        scene = openings.well(daemon.folder, 2)
        few, many = (error(rays(scene, rays=n, arguments=WHITE, render=daemon.render), expected) for n in (4, 64))
        print(f"mean square of the relative error: {few:.2e} by 4 rays, {many:.2e} by 64")
        self.assertLess(many, few / 8)

    def test_ambient_that_every_surface_hides(self):
        """Without a fall-off, ambient light comes from where no surface is: as a sky's."""
        expected = .5 * openings.seen_from_floor(1, SIDE)
        picture = rays(openings.well(daemon.folder, 1), rays=64, ambient=1, ao=0)
        self.assertLess(abs(picture.mean() / expected.mean() - 1), .02)
        self.assertLess(error(picture, expected), 2e-3)

    def test_full_detail(self):
        expected = .5 * openings.seen_from_floor(1, SIDE)
        picture = rays(openings.well(daemon.folder, 1), rays=16, detail="full", arguments=WHITE)
        self.assertLess(abs(picture.mean() / expected.mean() - 1), .02)

    def test_more_rays_than_a_pass_has(self):
        expected = .5 * openings.seen_from_floor(1, SIDE)
        picture = rays(openings.well(daemon.folder, 1), rays=250, arguments=WHITE)
        self.assertLess(abs(picture.mean() / expected.mean() - 1), .01)
        self.assertLess(error(picture, expected), 1e-3)


class Pictures(unittest.TestCase):
    def test_a_sun_in_a_picture_is_found_by_its_table(self):
        """One texel of a dark sky: by the cosine alone hardly any ray would meet it."""
        sky = skies.spot(64, 32, 20, 5, 1e3)
        path = os.path.join(daemon.folder, "sun.exr")
        images.write(path, sky)
        scene = rooms.plane(daemon.folder, .7)
        picture = rays(scene, arguments=["--background", path])
        expected = .7 / numpy.pi * skies.irradiance(sky, (0, 1, 0)).mean()
        self.assertLess(abs(picture.radiance[8:24, 8:24].mean() / expected - 1), .02)

    def test_even_picture_is_the_colour(self):
        path = os.path.join(daemon.folder, "even.exr")
        images.write(path, skies.even(32, 16))
        scene = openings.well(daemon.folder, 1)
        expected = .5 * openings.seen_from_floor(1, SIDE)
        picture = rays(scene, rays=64, arguments=["--background", path])
        self.assertLess(abs(picture.mean() / expected.mean() - 1), .02)


def under_a_roof(pane, roof):
    """A floor, and over it as wanted a pane of glass that leaves light as it is, 1 m up, and a black roof, 2 m up."""
    g = Gltf()
    for name, height, there, look in (("floor", 0, True, {"albedo": (.5,) * 3}), ("roof", 2, roof, {"albedo": (0, 0, 0)}),
                                      ("pane", 1, pane, {"clear": 1, "roughness": 0})):
        if there:
            g.place(*quad((-3, height, 3), (3, height, 3), (3, height, -3), (-3, height, -3)), g.material(name, **look))
    g.camera((0, .8, .01), (0, 0, 0), 60)
    return g.save(daemon.folder, f"roof_{pane:d}_{roof:d}.gltf")


class Panes(unittest.TestCase):
    """A pane is no surface that light comes from: rays go on behind it, as far as they would without it."""
    def check(self, roof, **options):
        bare, behind = (rays(under_a_roof(pane, roof), 32, **options).radiance for pane in (False, True))
        self.assertGreater(float(bare.mean()), .02)
        self.assertLess(float(numpy.abs(behind / bare - 1).max()), .01)

    def test_ambient_light_under_a_pane(self):
        picture = rays(under_a_roof(True, False), 32, ambient=1)
        self.assertLess(float(numpy.abs(picture.radiance / .5 - 1).max()), 1e-3)

    def test_a_roof_is_as_far_as_without_a_pane(self):
        self.check(True, ambient=1)

    def test_rays_end_as_far_as_without_a_pane(self):
        self.check(True, distance=2.2, arguments=WHITE)


class Near(unittest.TestCase):
    def test_thin_walls_hold_the_light(self):
        """Of a quarter of a voxel, aligned and oblique: rays end in the triangles, and the sides of a wall are apart."""
        for turned in (0, 30):
            for shift in rooms.LEAK_SHIFTS:
                with self.subTest(turned=turned, shift=shift):
                    scene = rooms.TwoRooms(daemon.folder, 64, .25, shift, turned)
                    mean, high = rooms.leak(daemon, scene, 64, (32, 32), {"vct.gather": "rays"})
                    print(f"turned {turned}, shift {shift:.2f}: mean {100 * mean:.3f} %, 99th percentile {100 * high:.2f} %")
                    self.assertLess(mean, .01)

    def test_plane_does_not_see_itself(self):
        for albedo in (.7, 1.0):
            picture = rays(rooms.plane(daemon.folder, albedo), 32, arguments=WHITE)
            self.assertLess(float(numpy.abs(picture.radiance[6:26, 6:26] / albedo - 1).max()), 1e-4)

    def test_closed_room(self):
        """As test_rooms.py has it of cones: 1 − ρ^(events + 1). Turned by 30 degrees they may be 12 % off. In 32 voxels one
        entry of seven is in a corner, where two walls are one; the error of a bounce is in the next, too."""
        for turned in (0, 30):
            scene = rooms.uniform_room(daemon.folder, .8, 2.0, turned)
            for bounces in (1, 3):
                with self.subTest(turned=turned, bounces=bounces):
                    picture = rays(scene, 32, bounces=bounces, emitters="points")
                    share = picture.mean() / (1 - .8 ** (bounces + 2))
                    print(f"turned {turned}, {bounces} bounces: {share:.4f}")
                    self.assertLess(abs(share - 1), .03 if bounces == 1 else .05)


if __name__ == "__main__":
    unittest.main()
