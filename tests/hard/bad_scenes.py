"""Every broken file of tests/scenes/bad.py and bad_patches.py is refused with the right code, or loads with what is wrong counted and said.
The loader itself must neither crash nor hang on any of them."""
import json
import os
import tempfile
import unittest

import bad
import bad_patches
from loader import describe

# What is not simply invalid.
CODES = {
    "unknown_ending": "scene-unsupported",
    "glb_version_1": "scene-unsupported",
    "gltf_version_1": "scene-unsupported",
    "gltf_required_extension": "scene-unsupported",
    "accessor_count_huge": "scene-limit",
    "instances_too_many": "scene-limit",
    "instances_many_times_much": "scene-limit",
    "instances_of_many_nodes": "scene-limit",
    "nodes_too_deep": "scene-limit",
    "missing_bin": "scene-file",
    "bin_is_a_fifo": "scene-file",
    "bin_outside": "scene-path",
    "bin_behind_a_link": "scene-path",
    "bin_absolute": "scene-path",
}

# What a mended scene must say: some of its numbers, and words that its warnings or ignored features hold.
EXPECTED = {
    "index_out_of_range": (dict(triangles=11, dropped_out_of_range=1), "not there: 1"),
    "nan_position": (dict(triangles=6, dropped_non_finite=6), "not finite"),
    "infinite_position": (dict(triangles=6, dropped_non_finite=6), "not finite"),
    "far_position": (dict(triangles=6, dropped_non_finite=6), "beyond 1e12"),
    "zero_scale_node": (dict(triangles=0, dropped_degenerate=12), "no triangle"),
    "deep_nodes_500": (dict(triangles=12), ""),
    "bin_longer_than_said": (dict(triangles=12), ""),
    "missing_image": (dict(triangles=12, textures=0, missing_textures=1), "no_such_image.png"),
    "image_outside": (dict(triangles=12, textures=0, missing_textures=1), "leads out of the scene's folder"),
    "image_absolute": (dict(triangles=12, textures=0, missing_textures=1), "leads out of the scene's folder"),
    "image_truncated": (dict(triangles=12, textures=0, missing_textures=1), "taken as white"),
    "image_is_text": (dict(triangles=12, textures=0, missing_textures=1), "no png or jpeg"),
    "image_empty": (dict(triangles=12, textures=0, missing_textures=1), "no png or jpeg"),
    "image_too_large": (dict(triangles=12, textures=0, missing_textures=1), "100000 x 100000"),
    "image_view_past_end": (dict(triangles=12, textures=0, missing_textures=1), "not in the file"),
    "image_percent_encoded": (dict(triangles=12, textures=1, missing_textures=0), ""),
    "sparse_position": (dict(triangles=12), ""),
    "points": (dict(triangles=0), "points"),
    "lines": (dict(triangles=0), "lines"),
    "strip": (dict(triangles=28, dropped_degenerate=6), ""),
    "fan": (dict(triangles=24, dropped_degenerate=10), ""),
    "bad_lights": (dict(triangles=12, punctual_lights=1), "light '' is left out"),
    "colour_above_one": (dict(triangles=12), "clamped"),
    "no_nodes": (dict(triangles=0, bvh_nodes=1), "no triangle"),
    "used_extension": (dict(triangles=12), "KHR_materials_sheen"),
    "read_extensions_required": (dict(triangles=12), ""),
    "factors_out_of_range": (dict(triangles=12), "clamped"),
    "ior_negative": (dict(triangles=12), "clamped"),
    "cutoff_negative": (dict(triangles=12), ""),
    "cutoff_over_tiny_alpha": (dict(triangles=12), ""),
    "normal_scale_huge": (dict(triangles=12), "normal scale"),
    "normal_map_without_coordinates": (dict(triangles=12), ""),
    "transform_huge": (dict(triangles=12), "transform that is not finite"),
    "colours_nan": (dict(triangles=12), "vertex colour"),
    "colours_negative": (dict(triangles=12), "vertex colour"),
    "second_set_nan": (dict(triangles=12), ""),
    "tangents_nan": (dict(triangles=12), ""),
    "sheen": (dict(triangles=12), "KHR_materials_sheen"),
    "coat_out_of_range": (dict(triangles=12), "clamped"),
    "coat_is_no_object": (dict(triangles=12), ""),
    "instances_of_nothing": (dict(triangles=0), "no triangle"),
    "instances_nan": (dict(triangles=12), "an instance of node"),
    "instances_without_attributes": (dict(triangles=12), ""),
    "alpha_blend": (dict(triangles=12), ""),
    "specular_alpha_texture": (dict(triangles=12, textures=2), ""),
    "obj_point_cloud": (dict(triangles=0), "no triangle"),
    "obj_degenerate": (dict(triangles=1, dropped_degenerate=3), "no area: 3"),
    "obj_concave": (dict(triangles=8, dropped_degenerate=0), ""),
    "obj_nan": (dict(triangles=1, dropped_non_finite=1), "not finite"),
    "obj_missing_mtl": (dict(triangles=2), "not_there.mtl"),
    "obj_mtl_outside": (dict(triangles=2), "leads out of the scene's folder"),
    "obj_undefined_usemtl": (dict(triangles=2), "'missing' is not defined"),
    "obj_missing_texture": (dict(triangles=2, missing_textures=1), "leads out of the scene's folder"),
    "obj_bright_and_wild": (dict(triangles=2, emissive_triangles=2, missing_textures=1), "out of range"),
    "obj_number_formats": (dict(triangles=1, bounds_min=[0.01, -2, -0.25]), ""),
    "obj_carriage_returns": (dict(triangles=1), ""),
    "obj_negative_indices": (dict(triangles=2), ""),
    "obj_lines": (dict(triangles=1), "lines"),
}


class BadScenes(unittest.TestCase):
    def check_refused(self, path, wanted, word=""):
        done = describe(path, timeout=120)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(done.stdout, "")
        sentences = [line for line in done.stderr.splitlines() if line.startswith("candil-loader: ")]
        self.assertEqual(len(sentences), 1, done.stderr)
        _, code, sentence = sentences[0].split(": ", 2)
        self.assertEqual(code, wanted, sentence)
        self.assertIn(word, sentence)
        self.assertGreater(len(sentence), 15)

    def check_patches(self, name, path):
        _, code, word = bad_patches.CASES[name]
        if code:
            self.check_refused(path, code, word)
            return
        done = describe(path, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(done.stdout)
        factors = [4, 0 if name == "mtx_of_nothing" else 5]
        self.assertEqual([info[key] for key in ("patch_elements", "factor_rows", "factor_entries")],
                         [4, 0, 0] if name.startswith("ply") else [0, *factors])
        self.assertEqual(info["facts"], ["patches" if name.startswith("ply") else "form factors"])
        self.assertEqual(len(info["warnings"]), word != "", info["warnings"])
        self.assertIn(word, "".join(info["warnings"]))

    def test_patches_are_the_same_in_any_order(self):
        for names in (("ply_sound", "ply_carriage_returns", "ply_further_numbers", "ply_another_order", "ply_other_names_of_types"),
                      ("mtx_sound", "mtx_by_columns", "mtx_any_order", "mtx_spaced")):
            hashes = set()
            for name in names:
                with tempfile.TemporaryDirectory() as folder:
                    hashes.add(json.loads(describe(bad_patches.CASES[name][0](folder)).stdout)["hash"])
            self.assertEqual(len(hashes), 1, names)

    def check_mended(self, name, path):
        done = describe(path, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(done.stdout)
        numbers, words = EXPECTED[name]
        for key, value in numbers.items():
            if isinstance(value, list):
                for got, want in zip(info[key], value):
                    self.assertAlmostEqual(got, want, 6)
            else:
                self.assertEqual(info[key], value, key + " " + done.stdout)
        self.assertIn(words, "\n".join(info["warnings"] + info["ignored"]))
        if not words:
            self.assertEqual([w for w in info["warnings"] if "without a material" not in w and "no area" not in w], [])


def add(name, write, check):
    def test(self):
        with tempfile.TemporaryDirectory() as folder:
            check(self, name, write(folder))
    setattr(BadScenes, "test_" + name, test)


for scene, writer in {**bad.BAD, **bad.ODD}.items():
    add(scene, writer, BadScenes.check_mended if scene in EXPECTED else
        lambda self, name, path: self.check_refused(path, CODES.get(name, "scene-invalid")))
for scene, (writer, _, _) in bad_patches.CASES.items():
    add(scene, writer, BadScenes.check_patches)

if __name__ == "__main__":
    unittest.main()
