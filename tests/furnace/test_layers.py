"""Clear coats and Oren and Nayar's diffuse part, where their light is known in closed form."""
import math
import unittest

import numpy

from render import Daemon
from writers import Gltf, quad

daemon = Daemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def plate(sun=None, **material):
    g = Gltf()
    g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("plate", **material))
    if sun is not None:
        g.light("directional", math.pi, target=sun, up=(1, 0, 0))
    return g.save(daemon.folder, "plate.gltf")


def at_angle(scene, degrees, spp=256, background=1, **more):
    """Mean radiance of the plate's middle, seen at an angle from its normal."""
    a = math.radians(degrees)
    camera = (0, 5 * math.cos(a), 5 * math.sin(a), 0, 0, 0, 0, 1, 0, 0.002) if degrees else (0, 5, 0, 0, 0, 0, 0, 0, -1, 0.002)
    picture = daemon.render(scene, size=(8, 8), spp=spp, camera=camera, arguments=["--background", ",".join([str(background)] * 3)], **more)
    return picture.radiance.reshape(-1, 3).mean(axis=0, dtype=numpy.float64)


class WhiteFurnace(unittest.TestCase):
    def check(self, name, angles, bound=0.01, **material):
        scene = plate(albedo=(1, 1, 1), **material)
        worst = max(float(numpy.abs(at_angle(scene, a) - 1).max()) for a in angles)
        print(f"{name}: worst {worst:.4f}")
        self.assertLess(worst, bound, name)

    def test_a_coat_over_what_returns_all_light_returns_all(self):
        below = {"Lambert": {}, "matte": {"matte": 1}, "plastic": {"specular": 1, "roughness": 0.3}, "rough plastic": {"specular": 1},
                 "mirror": {"specular": 1, "metallic": 1, "roughness": 0}, "rough metal": {"specular": 1, "metallic": 1, "roughness": 0.8}}
        for name, material in below.items():
            for roughness in (0, 0.4):
                # What matte facets send back is not spread as the film above lets it through: bsdf.glsl says how near it comes.
                self.check(f"coat of {roughness} on {name}", (0, 80), 0.02 if name == "matte" else 0.01, coat={"clearcoatFactor": 1, "clearcoatRoughnessFactor": roughness}, **material)

    def test_half_a_coat_too(self):
        self.check("half a coat", (0, 75), coat={"clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.2}, specular=1, roughness=0.5)

    def test_matte_facets_return_all_light(self):
        for r in (0.2, 1.0):
            self.check(f"matte {r}", (0, 60, 89), matte=r)
        self.check("matte under gloss", (0, 60, 80), 0.02, matte=1, specular=1, roughness=0.4)


class Coat(unittest.TestCase):
    def test_over_black_it_is_schlicks(self):
        """A smooth coat over black shows the world by 0.04 + 0.96 (1 - cos)^5, times how much of it is there."""
        for amount in (1, 0.25):
            scene = plate(albedo=(0, 0, 0), coat={"clearcoatFactor": amount})
            for angle in (0, 70, 85):
                fresnel = 0.04 + 0.96 * (1 - math.cos(math.radians(angle))) ** 5
                self.assertLess(abs(float(at_angle(scene, angle, spp=64)[0]) / (amount * fresnel) - 1), 0.002, (amount, angle))

    def test_it_takes_its_light_from_what_is_below(self):
        """A mirror of 0.5 under a smooth coat: Schlick's coat, and what that leaves of Schlick's mirror."""
        scene = plate(albedo=(0.5, 0.5, 0.5), metallic=1, roughness=0, specular=1, coat={"clearcoatFactor": 1})
        for angle in (0, 60, 80):
            grazing = (1 - math.cos(math.radians(angle))) ** 5
            coat, mirror = 0.04 + 0.96 * grazing, 0.5 + 0.5 * grazing
            self.assertLess(abs(float(at_angle(scene, angle, spp=1024)[0]) / (coat + (1 - coat) * mirror) - 1), 0.005, angle)


def let_through(cosine):
    """What a smooth coat leaves of the light from below."""
    return 0.96 * (1 - (1 - cosine) ** 5)


class CoatedLamp(unittest.TestCase):
    """A coat dims what is emitted below it by what it reflects, whichever way the light is found."""
    COAT = {"clearcoatFactor": 1}

    def test_as_it_is_seen(self):
        for amount in (1, 0.5):
            scene = plate(albedo=(0, 0, 0), emission=(1, 1, 1), coat={"clearcoatFactor": amount})
            for angle in (0, 60, 85):
                expected = 1 - amount + amount * let_through(math.cos(math.radians(angle)))
                self.assertLess(abs(float(at_angle(scene, angle, spp=4, background=0)[0]) / expected - 1), 0.002, (amount, angle))

    def lit(self, camera, coat, height, up, mirror=False, **more):
        """A floor below a lamp of side 1 that looks up or down."""
        g = Gltf()
        g.place(*quad((-15, 0, 15), (15, 0, 15), (15, 0, -15), (-15, 0, -15)), g.material("floor", (.5,) * 3))
        s = .5 if up else -.5
        g.place(*quad((-.5, height, s), (.5, height, s), (.5, height, -s), (-.5, height, -s)), g.material("lamp", (0, 0, 0), (1, 1, 1), coat=coat))
        if mirror:
            g.place(*quad((3, 2, -.8), (4.8, 2, -.8), (4.8, 2, .8), (3, 2, .8)), g.material("mirror", metallic=1, roughness=0, specular=1))
        return daemon.render(g.save(daemon.folder, "lit.gltf"), (16, 16), camera=camera, **more)

    @staticmethod
    def left(x, z, height, steps=16):
        """The share of a bare lamp's light that a coated one sends to (x, 0, z) from its middle (0, height, 0)."""
        at = (numpy.arange(steps) + 0.5) / steps - 0.5
        dx, dz = numpy.meshgrid(x - at, z - at)
        cosine = height / numpy.sqrt(dx * dx + dz * dz + height * height)
        return (let_through(cosine) * cosine ** 4).sum() / (cosine ** 4).sum()

    def test_by_each_way_of_sampling(self):
        """Beside a bare lamp, whose noise is the same."""
        camera = (2, 0.3, 0, 2, 0, 0, 0, 0, -1, 1)
        for way in ("mis", "nee", "none"):
            coated, bare = (float(self.lit(camera, coat, 0.7, False, spp=64, options={"pt.lights": way, "pt.depth": 1}).radiance.mean())
                            for coat in (self.COAT, None))
            expected = self.left(2, 0, 0.7)
            print(f"a coated lamp, {way}: {coated / bare:.4f}, {expected:.4f}")
            self.assertLess(abs(coated / bare / expected - 1), 0.01, way)

    def test_by_light_paths(self):
        """The lamp looks up, and a mirror above shows it to the floor far aside, at some 70 degrees."""
        camera = (9, 1, 0, 9, 0, 0, 0, 0, -1, 5)
        coated, bare = (self.lit(camera, coat, 0.5, True, True, spp=256, options={"pt.depth": 2}) for coat in (self.COAT, None))
        self.assertEqual({e["name"]: e["state"] for e in coated.report["effects"]}["caustics"], "simulated")
        got, expected = float(coated.radiance.mean() / bare.radiance.mean()), self.left(9, 0, 3.5)
        print(f"a coated lamp in a mirror: {got:.4f}, {expected:.4f}")
        self.assertLess(abs(got / expected - 1), 0.01)


class OrenNayar(unittest.TestCase):
    @staticmethod
    def value(rho, r, view, light):
        """pi f of Portsmouth, Kutz and Hill 2024, both directions in one plane with the normal, angles in degrees."""
        a = 1 / (1 + (0.5 - 2 / (3 * math.pi)) * r)

        def albedo(c):
            s = math.sqrt(1 - c * c)
            g = s * (math.acos(c) - s * c) + 2 / 3 * ((s / c) * (1 - s ** 3) - s)
            return a * (1 + r * g / math.pi)
        v, l = math.cos(math.radians(view)), math.cos(math.radians(light))
        s = math.cos(math.radians(view - light)) - v * l
        single = rho * a * (1 + r * (s / max(v, l) if s > 0 else s))
        mean = a * (1 + (2 / 3 - 28 / (15 * math.pi)) * r)
        again = rho * rho * mean / (1 - rho * (1 - mean))
        return single + again * (1 - albedo(v)) * (1 - albedo(l)) / (1 - mean)

    def test_a_suns_light_as_the_paper_says(self):
        """The sun's irradiance is pi, so a plate shows pi f cos."""
        for rho, r in ((1, 1), (0.5, 0.5)):
            for light in (60, -60):
                way = math.radians(light)
                scene = plate(sun=(0, -math.cos(way), -math.sin(way)), albedo=(rho,) * 3, matte=r)
                for view in (0, 75):
                    got = float(at_angle(scene, view, spp=4, background=0)[0])
                    expected = self.value(rho, r, view, light) * math.cos(way)
                    self.assertLess(abs(got / expected - 1), 1e-3, (rho, r, light, view))

    def test_its_albedo_is_the_papers(self):
        """In a white world the sum over all directions, not only one: E of the paper."""
        for rho, r, angle in ((0.5, 1, 30), (0.5, 1, 80), (0.2, 0.5, 60)):
            steps = 2000
            total = 0.0
            for i in range(steps):    # over the light's polar angle, and its azimuth through the mean of s / t
                theta = (i + 0.5) / steps * math.pi / 2
                total += self.ring(rho, r, math.radians(angle), theta) * math.sin(theta) * math.cos(theta) * 2 * math.pi / 2 / steps
            got = float(at_angle(plate(albedo=(rho,) * 3, matte=r), angle, spp=1024)[0])
            self.assertLess(abs(got / total - 1), 0.01, (rho, r, angle))

    def ring(self, rho, r, view, light):
        """The mean of pi f over a ring of lights."""
        v, l = math.cos(view), math.cos(light)
        flat = math.sin(view) * math.sin(light)
        turns = [math.cos(2 * math.pi * (k + 0.5) / 64) * flat for k in range(64)]
        bend = sum(s / max(v, l) if s > 0 else s for s in turns) / 64
        a = 1 / (1 + (0.5 - 2 / (3 * math.pi)) * r)
        half = self.value(rho, r, math.degrees(view), math.degrees(light)) - rho * a * (1 + r * flat / max(v, l))
        return half + rho * a * (1 + r * bend)


if __name__ == "__main__":
    unittest.main()
