"""libcandil's poll-loop interface against a real daemon."""
import os
import tempfile

from common import BUILD, Daemon, run, skip_without_device, write_scene


def main():
    skip_without_device()
    with tempfile.TemporaryDirectory() as folder, Daemon(folder) as daemon:
        result = run(os.path.join(BUILD, "tests", "multiplex"), daemon.socket, write_scene(folder))
        assert result.returncode == 0, result


main()
