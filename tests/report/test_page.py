"""report.html and the page of `candil compare --html`: self-contained, escaped, small, with every figure as a table."""
import html.parser
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import numpy as np

import images
from studies import BIASED, NOISY, PROGRAM, Study, point

EVIL = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'&"
LIMIT = 3 * 1024 * 1024


class Page(html.parser.HTMLParser):
    """What a page has: tags with their attributes, the text of elements, the content of scripts."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.scripts, self.words, self.open = [], [], [], None
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self.open = tag
        if tag == "script":
            self.scripts.append("")

    def handle_endtag(self, tag):
        self.open = None

    def handle_data(self, data):
        if self.open == "script":
            self.scripts[-1] += data
        elif self.open != "style":
            self.words.append(data)

    def text(self):
        return " ".join(" ".join(self.words).split())

    def data(self):
        """What the scripts get."""
        kinds = [attrs.get("type") for tag, attrs in self.tags if tag == "script"]
        return json.loads(self.scripts[kinds.index("application/json")])


class Report(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def page(self, study, *arguments):
        study.run(*arguments)
        text = (study.folder / "report.html").read_text(encoding="utf-8")
        self.assertLessEqual(len(text.encode()), LIMIT)
        return Page(text), text

    def nothing_from_outside(self, page, text):
        for tag, attrs in page.tags:
            for name in ("src", "href", "srcset", "data", "action", "poster"):
                if name in attrs:
                    # What a reader may follow stays on this machine; nothing else is asked for.
                    self.assertRegex(attrs[name], r"^(#|file:///[\w/.~%-]+$)" if tag == "a" else r"^data:", tag)
            self.assertFalse([name for name in attrs if name.startswith("on")], tag)
            self.assertNotIn(tag, ("link", "iframe", "object", "embed", "base"))
        for url in re.findall(r"url\(([^)]*)\)", text):
            self.assertTrue(url.startswith("data:image/"), url[:40])
        self.assertNotIn("@import", text)
        policy = next(attrs["content"] for tag, attrs in page.tags if tag == "meta" and attrs.get("http-equiv") == "Content-Security-Policy")
        self.assertIn("default-src 'none'", policy)

    def test_every_figure_is_in_a_table(self):
        # Without a title the page has the scene's file for one.
        study = Study(self.folder).usual()
        page, text = self.page(study)
        results = json.loads((self.folder / "results.json").read_text())
        self.nothing_from_outside(page, text)
        words = page.text()
        self.assertGreaterEqual(sum(tag == "table" for tag, _ in page.tags), 4)
        for technique in results["techniques"]:
            for p in technique["points"]:
                self.assertIn(f"{technique['name']}, samples {p['settings']['samples']}", words)
                self.assertIn(p["command"], words)
        for word in results["words"]:
            self.assertIn(" ".join(word.split()), words)
        self.assertIn("What accuracy costs in time: made.gltf", words)
        for key in ("command", "device"):
            self.assertIn(study.json[key], words)
        self.assertEqual(page.data()["techniques"][0]["points"][0]["settings"], results["techniques"][0]["points"][0]["settings"])

    def test_pictures_are_on_the_page_and_beside_the_images(self):
        study = Study(self.folder).usual()
        page, text = self.page(study)
        shots = [attrs for tag, attrs in page.tags if tag == "figure" and "data-shot" in attrs]
        self.assertGreaterEqual(len(shots), 4)
        for attrs in shots:
            for letter in "pef"[:1 + 2 * int(attrs["data-maps"])]:
                self.assertEqual(text.count(f".{letter}{attrs['data-shot']}{{background-image:url(data:image/"), 1)
        written = {path.name for path in (self.folder / "images").glob("*.png")}
        self.assertLessEqual({"reference.png", "b-4-0.png", "b-4-0-error.png", "b-4-0-flip.png", "b-4-0-bias.png"}, written)
        np.testing.assert_array_equal(images.rgb(self.folder / "images/b-4-0.png").shape, (32, 48, 3))
        # Exposure: the reference's 95th percentile of luminance is at 0.8 of the display's light.
        shown = images.rgb(self.folder / "images/reference.png")
        light = np.where(shown <= .04045, shown / 12.92, ((shown + .055) / 1.055) ** 2.4)
        self.assertAlmostEqual(np.percentile(images.luminance(light), 95), .8, delta=.05)

    def test_a_technique_within_the_references_own_error_is_not_without_a_picture(self):
        study = Study(self.folder).usual()
        study.lines[0]["report"].update(estimated_relmse=.005, relmse_low=.004, relmse_high=.012)
        page, _ = self.page(study)
        words = page.text().split("At equal error")[1].split("Noise or bias")[0]
        self.assertIn(f"{NOISY} has one within the reference's own error.", words)
        self.assertNotIn(f"{NOISY} has no picture so accurate", words)

    def test_maps_of_bias_show_where_it_is(self):
        Study(self.folder, size=(64, 64)).usual().run()
        shown = images.rgb(self.folder / "images/b-4-0-bias.png")
        self.assertEqual(shown.shape, (8, 8, 3))
        grey = np.abs(shown - 128 / 255).max(axis=2) < .01
        self.assertGreater(grey[:, :4].mean(), .9)
        self.assertLess(grey[:, 4:].mean(), .1)
        self.assertTrue((shown[:, 4:, 0] > shown[:, 4:, 2])[~grey[:, 4:]].all(), "brighter is orange")

    def test_what_the_first_of_its_settings_costs_is_on_the_page(self):
        """A cold run for which nothing had to be compiled has made what the scene keeps: warm times do not have it."""
        study = Study(self.folder).usual()
        study.add("cold", study.noisy(.1), kind="cold", technique=BIASED, settings={"samples": 1, "vct.resolution": 64}, seconds=3,
                  report={"stages": [{"name": "voxelise", "us": 2900000}, {"name": "trace", "us": 100000}]})
        page, _ = self.page(study)
        self.assertIn(f"{BIASED}, samples 1, vct.resolution 64 first of its settings 3.0 s voxelise\u00a02.9 s, trace\u00a0100 ms".replace("\u00a0", " "),
                      page.text())
        self.assertIn("they leave out what the scene keeps from run to run", page.text())

    def test_text_from_outside_is_text(self):
        study = Study(self.folder).usual()
        study.json.update(title=EVIL, command=EVIL, device=EVIL, notes=[EVIL], skipped=[{"technique": EVIL, "why": EVIL}])
        study.json["scene"]["file"] = EVIL
        study.json["machine"][EVIL] = EVIL
        study.json["views"][0]["name"] = EVIL
        study.json["missing"] = [{"run": EVIL, "why": EVIL}]
        for line in study.lines:
            line["command"] = EVIL
            line["report"]["stages"][0]["name"] = EVIL
        study.lines[3]["settings"] = {"samples": 1, EVIL: EVIL}
        study.add("evil", None, technique=EVIL, failed={"code": 1, "name": "x", "message": EVIL})
        study.lines[5]["technique"] = EVIL[:40]
        table = self.folder / "TABLE.md"
        table.write_text(f"## {EVIL}\n\n| case | technique |\n| --- | --- |\n| {EVIL} | `{NOISY}` |\n")
        page, text = self.page(study, "--tables", table)
        self.nothing_from_outside(page, text)
        self.assertNotIn("alert(1)</script>", text)
        self.assertEqual(sum(tag == "img" for tag, _ in page.tags), 0)
        self.assertEqual(sum(tag == "script" for tag, _ in page.tags), 3)
        self.assertNotIn("alert", "".join(page.scripts[1:]))
        self.assertEqual(page.data()["study"]["title"], EVIL)
        self.assertIn("<img src=x", page.text())

    def test_without_chart_js_the_tables_stay_and_the_page_says_so(self):
        study = Study(self.folder).usual()
        page, _ = self.page(study, "--chart", self.folder / "nothing.js")
        self.assertIn("Chart.js was not found", page.text())
        self.assertGreaterEqual(sum(tag == "table" for tag, _ in page.tags), 4)
        self.assertEqual(page.scripts[1].strip(), "")
        library = self.folder / "some.js"
        library.write_text("/* a library */ const a = '</script>';")
        page, _ = self.page(study, "--chart", library)
        self.assertEqual(page.scripts[1].strip(), "/* a library */ const a = '<\\/script>';")
        self.assertNotIn("Chart.js was not found", page.text())

    def test_rows_of_hard_cases_are_those_of_the_techniques(self):
        study = Study(self.folder).usual()
        table = self.folder / "TABLE.md"
        table.write_text("# Hard cases\n\n## Size\n\nWords.\n\n| case | technique | value |\n| --- | --- | ---: |\n| a small room | `pt` | 1 |\n"
                         "| a small room | `direct` | 2 |\n\n## Other\n\n| case | technique | value |\n| --- | --- | ---: |\n| a big room | `direct` | 3 |\n")
        page, _ = self.page(study, "--tables", table)
        self.assertIn(("a", {"href": table.resolve().as_uri()}), page.tags)
        self.assertIn("Size case technique value a small room pt 1", page.text())
        self.assertNotIn("direct", page.text())
        page, _ = self.page(study)
        self.assertIn("the rows of tests/hard/TABLE.md", page.text(), "the page that is installed")
        page, _ = self.page(study, "--tables", self.folder / "missing.md")
        self.assertIn("missing.md", page.text())

    def test_large_pictures_and_many_points_keep_the_page_small(self):
        study = Study(self.folder, size=(512, 512), seed=4).usual(seeds=2)
        for k in range(200):
            study.lines.append({**study.lines[1 + k % 8], "id": f"more-{k}", "settings": {"samples": 100 + k}, "command": "x" * 4000,
                                "image": study.lines[1]["image"] if k < 3 else None})
        page, text = self.page(study)
        self.assertGreater(len(text), 1024 * 1024)
        self.assertIn("background-image", text)

    def test_a_page_that_would_be_too_long_leaves_tables_out(self):
        """Many points with many stages, then also many words: what is kept is the front, and the page says what is not there."""
        study = Study(self.folder).usual(seeds=2)
        line = study.lines[1]
        stages = [{"name": f"stage {i} " + "x" * 80, "us": 10} for i in range(16)]
        for k in range(1200):
            study.lines.append({**line, "id": f"more-{k}", "settings": {"samples": 100 + k}, "image": None,
                                "report": {**line["report"], "stages": stages}})
        page, _ = self.page(study)
        self.assertIn("They find no room on this page, and are in results.json.", page.text())
        self.assertIn("samples 1000", page.text())
        for k in range(1200):
            study.lines.append({**line, "id": f"longer-{k}", "settings": {"samples": 9000 + k, "y": "z" * 1500}, "image": None})
        page, _ = self.page(study)
        self.assertIn("Only those of the Pareto front find room on this page", page.text())
        for p in (p for t in json.loads((self.folder / "results.json").read_text())["techniques"] for p in t["points"] if p["pareto"]):
            self.assertIn(f"samples {p['settings']['samples']}", page.text())

    def test_every_column_has_a_scope_and_every_table_a_name(self):
        page, text = self.page(Study(self.folder).usual())
        self.assertEqual({attrs.get("scope") for tag, attrs in page.tags if tag == "th"}, {"col"})
        self.assertNotIn("<caption></caption>", text)

    def test_a_folder_without_a_run_has_a_report(self):
        study = Study(self.folder)
        study.json.update(complete=False, ended=None)
        page, _ = self.page(study)
        self.assertIn("The study is not complete", page.text())
        self.assertIn("has no reference", page.text())


class Compare(unittest.TestCase):
    def test_page_of_three_pictures(self):
        with tempfile.TemporaryDirectory() as name:
            folder, random = pathlib.Path(name), np.random.default_rng(1)
            b = random.uniform(0, 2, (24, 32, 3))
            evil = folder / "<script>alert(1)<&.exr"
            images.write(folder / "b.exr", b)
            images.write(folder / "a.exr", b + random.normal(0, .1, b.shape))
            images.write(evil, b * 1.2)
            compare = [PROGRAM.parent / "candil-compare", folder / "a.exr", folder / "b.exr"]
            done = subprocess.run([*compare, evil, "--html", folder / "out.html", "--json"], capture_output=True, text=True, timeout=120)
            self.assertEqual(done.returncode, 0, done.stderr)
            text = (folder / "out.html").read_text(encoding="utf-8")
            page = Page(text)
            Report.nothing_from_outside(self, page, text)
            self.assertEqual([attrs["data-maps"] for tag, attrs in page.tags if tag == "figure"], ["1", "0", "1"])
            self.assertEqual(sum(tag == "script" for tag, _ in page.tags), 1)
            got = json.loads(done.stdout)
            self.assertIn(f"{got['flip']:.4g}", page.text())
            self.assertIn(f"{images.relmse(b * 1.2, b):.3g}"[:4], page.text())
            # Three pictures are for a page alone; a page that cannot be written is a failure.
            self.assertEqual(subprocess.run([*compare, evil], capture_output=True, timeout=60).returncode, 2)
            self.assertEqual(subprocess.run([*compare, "--html", folder / "no/out.html"], capture_output=True, timeout=60).returncode, 1)
            self.assertEqual(subprocess.run([*compare, folder / "none.exr", "--html", folder / "o.html"], capture_output=True, timeout=60).returncode, 1)
            self.assertFalse((folder / "o.html").exists())


if __name__ == "__main__":
    unittest.main()
