"""The page of hard cases, tests/hard/TABLE.md: what tests measured there, each with what it had to be. A row is a test's check.

    class Near(HardCase):
        def test_a_lamp_close_to_the_floor(self):
            picture = daemon.twice(scene, ...)
            self.row("near", "lamp 1 mm over a floor", picture, mean(picture), expected, "Lambert's polygon formula", 0.002)

Rows wait in build/table, a file for each test program, until the test `hard_table` holds the page against all of them, or writes it:

    table.py TEST.py...     rows of these tests; with CANDIL_TABLE=write the page is written
"""
import datetime
import difflib
import json
import os
import sys
import unittest

SOURCE, BUILD = os.environ["CANDIL_SOURCE"], os.environ["CANDIL_BUILD"]
PAGE = os.path.join(SOURCE, "tests", "hard", "TABLE.md")
HEAD = "Measured "
TECHNIQUES = ("pt", "direct", "vct")
ALL = (*TECHNIQUES, "radiosity")  # of the page, in its order
DRIFT = .01  # of the tolerance: so much may a value be off the page where it was measured; bits of another sum move it by less
PRINTED = 1e-5  # the rounding of six digits
REMEDY = "if the new values are right, `sh deploy/test --table` writes tests/hard/TABLE.md anew"

# Of each kind of hard case: its title, and what is hard about it.
KINDS = {
    "size": ("Size", "A float has 24 bits: a margin that suits a room is coarser than a grain and finer than the rounding in a landscape."),
    "place": ("Place", "6,400 km from the origin a float is half a metre coarse."),
    "near": ("Near, touching, in one plane", "The closer a lamp is to what it lights, the more of its light goes by where on it a sample "
             "falls; a ray that starts on a surface must not meet that surface, and must meet the next, however close."),
    "small": ("Next to nothing in size", "A lamp that is small sends as much from next to nowhere, one without area nothing; a cone of a "
              "tenth of a degree has cosines that differ from one in the seventh digit."),
    "angle": ("Grazing angles", "Cosines next to zero divide, multiply and are compared with zero."),
    "thin": ("Needles and slivers", "The normal of a triangle ten thousand times as long as it is wide, and where on it a ray hits, are "
             "differences of numbers that are nearly alike."),
    "range": ("Radiances decades apart", "What is dim is below the rounding of what is bright."),
    "many": ("Very many", "Sums over thousands of lamps, layers or samples, each of which is next to nothing of all."),
    "away": ("Behind and away", "Light from behind is none, by every sign of every cosine: 0 is exact."),
    "form": ("Form factors", "What two patches exchange is a millionth of a millionth of either where they graze each other from afar, and "
             "all of it where they nearly touch; what is hidden, behind or in one plane is exactly 0."),
    "camera": ("Cameras", "Fields of view of a tenth of a degree and of 179, parallel rays, pictures of one pixel."),
    "closed": ("Light that stays", "In a closed room an error of one bounce is in all that follow."),
    "rough": ("Polished and rough", "A lobe is a spike at roughness 0 and a hemisphere at 1; in a white world it may neither lose light nor gain any."),
    "glass": ("Glass", "Total reflection, an index of one, bodies in each other: which side a ray is on is a matter of bits."),
    "sky": ("Suns and skies", "A sun may be a thousandth of a degree wide or half the sky; a picture of the sky may be one texel."),
    "texture": ("Textures", "Coordinates below zero, sides that are no power of two, sixteen bits."),
    "output": ("Extreme exposure", "Between black and white lie eight bits, wherever the exposure puts them."),
    "edit": ("Edits and animation", "A scene that is changed by a request is the scene that a file has so."),
}


def rows_of(test):
    """Where the rows of a test program wait."""
    return os.path.join(BUILD, "table", os.path.relpath(test, os.path.join(SOURCE, "tests")).replace(os.sep, ".") + ".jsonl")


def error_of(row):
    """Relative to what is expected; of an expected 0 the value itself."""
    return abs(row["value"] - row["expected"]) / (abs(row["expected"]) or 1)


class HardCase(unittest.TestCase):
    def row(self, kind, case, picture, value, expected, source, tolerance):
        """Hold a value to what is expected, and leave it for the page. `picture` is what it was measured in, or a list of all, each
        rendered twice; the tolerance is that of error_of. `source` says where the expected value comes from, and why a wide tolerance
        is no narrower."""
        pictures = picture if isinstance(picture, (list, tuple)) else [picture]
        row = {"kind": kind, "case": case, "technique": pictures[0].metadata["candil/technique"], "value": float(value),
               "expected": float(expected), "source": source, "tolerance": tolerance,
               "non_finite": sum(p.non_finite() for p in pictures), "same_bits": all(p.same_bits for p in pictures),
               "device": pictures[0].metadata["candil/device"]}
        path = rows_of(os.path.abspath(sys.argv[0]))
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
        told = f"{case}, {row['technique']}: {value:.6g}, expected {expected:.6g} ({source})"
        print(told)
        self.assertIn(kind, KINDS)
        self.assertLessEqual(error_of(row), tolerance, told)
        self.assertEqual(row["non_finite"], 0, told)
        self.assertTrue(row["same_bits"], told + ": the second picture has other bits")


def processor():
    """A software driver computes on it."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return next((line.split(":")[1].strip() for line in file if line.startswith("model name")), "unknown processor")


def measured(tests):
    """All rows, those of one case beside each other."""
    if not any(os.path.exists(rows_of(test)) for test in tests):
        print("skipped: no test has left rows, so that none had a device, or none was run: `ctest -R hard_table` runs all")
        sys.exit(77)
    rows = []
    for test in tests:
        try:
            with open(rows_of(test), encoding="utf-8") as file:
                rows += [json.loads(line) for line in file]
        except FileNotFoundError:
            sys.exit(f"{test} has left no rows: run it first, or all by `ctest -R hard_table`")
    keys = [(row["kind"], row["case"], row["technique"]) for row in rows]
    twice = sorted({key for key in keys if keys.count(key) > 1})
    if twice:
        sys.exit(f"two rows of one name: {twice}")
    order = {key: i for i, key in reversed(list(enumerate((row["kind"], row["case"]) for row in rows)))}
    return sorted(rows, key=lambda r: (list(KINDS).index(r["kind"]), order[r["kind"], r["case"]], ALL.index(r["technique"])))


def line_of(row):
    error = error_of(row)
    cells = (row["case"], f"`{row['technique']}`", f"{row['value']:.6g}", f"{row['expected']:.6g}", row["source"], f"{error:.1e}" if error else "0",
             f"{row['tolerance']:g}", str(row["non_finite"]), "yes" if row["same_bits"] else "no")
    return f"| {' | '.join(cells)} |"


def page_of(rows, day):
    count = ", ".join(f"{sum(r['technique'] == t for r in rows)} of `{t}`" for t in ALL)
    text = f"""# Hard cases

Where numbers are short, light is rare or shapes are next to nothing: what candil answers, beside what is right. Each row is the check
of a test, which fails unless the error is within the tolerance, every pixel is finite, and a second picture of the same request, made
in other pieces, has the same bits. The test `hard_table` holds this page to what the tests measure, to a hundredth of the tolerance where
it was measured and to the tolerance elsewhere; `sh deploy/test --table` writes it.

{HEAD}{day} on {rows[0]['device']}; {processor()}.

**{len(rows)} rows**: {count}. Errors are relative to what is expected; where that is 0, an error is the value itself.
"""
    for kind, (title, why) in KINDS.items():
        lines = [line_of(row) for row in rows if row["kind"] == kind]
        if lines:
            text += f"\n## {title}\n\n{why}\n\n| case | technique | value | expected | from | error | tolerance | non-finite | same bits |\n"
            text += "| --- | --- | ---: | ---: | --- | ---: | ---: | ---: | --- |\n" + "\n".join(lines) + "\n"
    return text


def cells_of(text):
    """Of each row of a page."""
    return [line.split(" | ") for line in text.splitlines() if line.endswith(("| yes |", "| no |"))]


def blanked(text):
    """A page without what another machine may have otherwise."""
    lines = []
    for line in text.splitlines():
        for cells in cells_of(line):
            line = " | ".join([*cells[:2], "", "", cells[4], "", *cells[6:]])
        lines.append(HEAD if line.startswith(HEAD) else line)
    return "\n".join(lines)


def check(rows):
    with open(PAGE, encoding="utf-8") as file:
        page = file.read()
    head = next(line for line in page.splitlines() if line.startswith(HEAD))
    now = page_of(rows, head[len(HEAD):].split()[0])
    here = head in now
    if not here:
        print(f"The page was {head[0].lower()}{head[1:]} Here its values have to be within their tolerances, and all else the same.")
    lines = list(difflib.unified_diff(blanked(page).splitlines(), blanked(now).splitlines(), "on the page", "measured", lineterm="", n=0))
    for row, cells in zip(rows, cells_of(page) if not lines else []):
        told = float(cells[2])
        off = abs(told - row["value"]) / (abs(row["expected"]) or 1) if here else error_of(dict(row, value=told))
        if off > row["tolerance"] * (DRIFT if here else 1) + PRINTED:
            lines.append(f"measured {row['value']:.6g}, on the page: {' | '.join(cells)}")
    if lines:
        sys.exit("\n".join([*lines[:80], f"{len(lines)} lines are not as measured: {REMEDY}"]))
    print(f"{len(rows)} rows are as the page has them")


def write(rows):
    with open(PAGE, "w", encoding="utf-8") as file:
        file.write(page_of(rows, datetime.date.today().isoformat()))
    print(f"wrote {len(rows)} rows to {PAGE}")


if __name__ != "__main__":
    # A test begins: what it left before is no measurement of this run, even if it is skipped now.
    if os.path.exists(rows_of(os.path.abspath(sys.argv[0]))):
        os.remove(rows_of(os.path.abspath(sys.argv[0])))
else:
    (write if os.environ.get("CANDIL_TABLE") == "write" else check)(measured(sys.argv[1:]))
