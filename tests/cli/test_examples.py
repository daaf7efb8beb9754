"""Both examples get the same picture out of one daemon, and fail where they should."""
import os
import sys
import tempfile

import numpy
import OpenImageIO as oiio

from common import BUILD, SOURCE, Daemon, run, skip_without_device, write_scene


def pixels(path):
    image = oiio.ImageInput.open(path)
    assert image, oiio.geterror()
    return numpy.asarray(image.read_image(format=oiio.UINT8))


def main():
    skip_without_device()
    minimal = [os.path.join(BUILD, "examples", "minimal")]
    client = [sys.executable, os.path.join(SOURCE, "clients", "examples", "client.py")]
    with tempfile.TemporaryDirectory() as folder, Daemon(folder) as daemon:
        scene = write_scene(folder)
        pictures = []
        for name, example in (("c.png", minimal), ("python.png", client)):
            out = os.path.join(folder, name)
            result = run(*example, daemon.socket, scene, out)
            assert result.returncode == 0, result
            pictures.append(pixels(out))
            assert run(*example, daemon.socket, scene + ".missing", out).returncode == 1
            assert run(*example, daemon.socket + ".missing", scene, out).returncode == 1
        assert pictures[0].shape == (128, 128, 3)
        wall, background = pictures[0][64, 64].astype(int), pictures[0][2, 2].astype(int)
        assert abs(background - 188).max() <= 1, "radiance 0.5 through the sRGB curve"
        assert abs(wall - background).max() > 5, "a wall that the lamp lights"
        assert (pictures[0] == pictures[1]).all(), "the two examples ask for the same picture"


main()
