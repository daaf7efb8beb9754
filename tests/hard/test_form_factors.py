"""Form factors of patches whose factors are known, by every way to find them: from closed forms, by symmetry, and from what light that
is all there must add up to. They are measured without a daemon, by tests/hard/form_factor_rows.c."""
import json
import os
import subprocess
import sys
import unittest

from table import BUILD, HardCase


class Measured:
    """What a row needs to know of a picture, of which there is none."""

    def __init__(self, device, same_bits):
        self.metadata = {"candil/technique": "radiosity", "candil/device": device}
        self.same_bits = same_bits

    def non_finite(self):
        return 0


def measured():
    told = subprocess.run([os.path.join(BUILD, "tests", "form_factor_rows")], stdout=subprocess.PIPE, text=True)
    if told.returncode == 77:
        sys.exit(77)
    told.check_returncode()
    return [json.loads(line) for line in told.stdout.splitlines()]


class FormFactors(HardCase):
    def test_all_that_are_known(self):
        first, *rows = measured()
        self.assertGreater(len(rows), 100)
        for row in rows:
            with self.subTest(case=row["case"]):
                self.row("form", row["case"], Measured(first["device"], row["same_bits"]), row["value"], row["expected"], row["source"],
                         row["tolerance"])


if __name__ == "__main__":
    unittest.main()
