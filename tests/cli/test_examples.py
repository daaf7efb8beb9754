"""Both examples get the same picture out of one daemon, and fail where they should."""
import os
import signal
import subprocess
import sys
import tempfile

import numpy
import OpenImageIO as oiio

import wire
from common import BUILD, SOURCE, Daemon, run, skip_without_device, write_scene
from fakes import LIBEXEC

MINIMAL = [os.path.join(BUILD, "examples", "minimal")]
CLIENT = [sys.executable, os.path.join(SOURCE, "clients", "examples", "client.py")]


def pixels(path):
    image = oiio.ImageInput.open(path)
    assert image, oiio.geterror()
    return numpy.asarray(image.read_image(format=oiio.UINT8))


def check_interrupts(examples):
    """Ctrl-C and SIGTERM cancel an example's render, and its scene is gone afterwards."""
    for number in (signal.SIGINT, signal.SIGTERM):
        for example in examples:
            with tempfile.TemporaryDirectory() as folder:
                out, scene = (os.path.join(folder, name) for name in ("out.png", "ok.gltf"))
                with open(scene, "w") as file:
                    file.write("ok")
                with wire.Daemon(libexec=LIBEXEC, environment={"FAKE_STEP_US": "500000"}) as daemon, daemon.connect() as other:
                    process = subprocess.Popen([*example, daemon.socket, scene, out], stderr=subprocess.PIPE,
                                               preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
                    wire.wait_for(lambda: other.stats().jobs, "it renders")
                    process.send_signal(number)
                    _, error = process.communicate(timeout=wire.PATIENCE)
                    assert process.returncode == 1 and b"cancelled" in error, (process.returncode, error)
                    assert not other.ask(wire.LIST_SCENES).body.scenes
                    assert not os.path.exists(out)


def main():
    check_interrupts((MINIMAL, CLIENT))
    skip_without_device()
    with tempfile.TemporaryDirectory() as folder, Daemon(folder) as daemon:
        scene = write_scene(folder)
        pictures = []
        for name, example in (("c.png", MINIMAL), ("python.png", CLIENT)):
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
