"""Light that stays in a closed room: each bounce is counted once and none is lost."""
import unittest

import rooms
from common import VctDaemon
from table import HardCase

daemon = VctDaemon()

# Where walls lie along the voxels' axes the series holds within 3 %. Turned by 30 degrees, lamps by points: an oblique wall
# shows its back on one axis to who looks along it (vct_inject.comp.glsl), and an error of one bounce is in the next, too.
ASKED = 0.03
TURNED = {0.5: 0.05, 0.8: 0.12}
# Emission by cones alone has one gather more through voxels, and all of it is the room's own: nothing direct hides the error.
CONES = {0: {0.5: 0.03, 0.8: 0.04}, 30: {0.5: 0.12, 0.8: 0.18}}


def setUpModule():
    unittest.enterModuleContext(daemon)


class UniformRoom(HardCase):
    """Albedo rho, emission 1 - rho: 1 - rho^(N+1) after N events; `vct.bounces` is one less, for direct light is no bounce."""

    def check(self, tolerance, rho, size, turned, bounces, resolution=32, emitters="points", why="an oblique wall shows its back on one axis"):
        scene = rooms.uniform_room(daemon.folder, rho, size, turned)
        picture = daemon.vct(scene, resolution, bounces=bounces, emitters=emitters, render=daemon.twice)
        turn = f", turned by {turned}°" if turned else ""
        self.row("closed", f"a room of albedo {rho} and {size:g} m{turn}, {bounces} bounce{'s' if bounces > 1 else ''}, lamps by {emitters}, {resolution} voxels",
                 picture, picture.mean(), 1 - rho ** (bounces + 2), "1 − ρ^(events + 1)" + (f"; {why}" if tolerance > ASKED else ""), tolerance)

    def test_aligned(self):
        for rho in (0.5, 0.8):
            for bounces in (1, 2, 3):
                with self.subTest(rho=rho, bounces=bounces):
                    self.check(ASKED, rho, 2.0, 0, bounces)

    def test_of_any_size(self):
        for size in (0.01, 300.0):
            self.check(ASKED, 0.8, size, 0, 2)

    def test_finer_voxels(self):
        self.check(ASKED, 0.8, 2.0, 0, 2, resolution=64)

    def test_turned_without_bounces(self):
        """Lamps in closed form: no point lies over its own wall, by however little."""
        scene = rooms.uniform_room(daemon.folder, 0.5, 2.0, 30)
        picture = daemon.vct(scene, bounces=0, emitters="points").radiance
        self.assertLess(float(abs(picture / 0.75 - 1).max()), 0.01)

    def test_turned(self):
        for rho, tolerance in TURNED.items():
            for bounces in (1, 2, 3):
                with self.subTest(rho=rho, bounces=bounces):
                    self.check(tolerance, rho, 2.0, 30, bounces)

    def test_emission_by_cones(self):
        for turned, bounds in CONES.items():
            for rho, tolerance in bounds.items():
                with self.subTest(turned=turned, rho=rho):
                    self.check(tolerance, rho, 2.0, turned, 2, emitters="cones", why="one gather more through voxels")


if __name__ == "__main__":
    unittest.main()
