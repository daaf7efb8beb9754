"""The loader by itself, run as candild runs it: only for a scene that asks for it with the library of image formats, which takes a
quarter of a second to link."""
import os
import subprocess

LOADER = os.path.join(os.environ["CANDIL_BUILD"], "libexec", "candil", "candil-loader")
WANTS_IMAGES = 3  # exit code


def describe(path, *more, **options):
    """`--describe` of the scene at `path`, as subprocess.run leaves it; `options` are for that."""
    command = [LOADER, "--describe", "--dir", os.path.dirname(path), "--file", os.path.basename(path), *more]
    for images in ([], ["--images"]):
        done = subprocess.run(command + images, capture_output=True, text=True, **options)
        if done.returncode != WANTS_IMAGES:
            break
    return done
