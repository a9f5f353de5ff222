# SPDX-License-Identifier: Apache-2.0
"""What imports say of materials, as far as it needs no Blender: names in OBJ files, FBX files, and pictures of a list.

That Blender's importers fill the list as it is here is in blender_test.py.
"""

import struct
import sys
import tracemalloc
import zlib
from types import SimpleNamespace

import harness

sys.path.insert(0, str(harness.SOURCE / "python"))

from gazetrace_report import import_materials  # noqa: E402

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"

FBX = """; FBX 7.4.0 project file
Creator: "by hand"
Objects: {
    Material: 3, "Material::first", "" {
        ShadingModel: "Lambert"
        Properties70: {
            P: "SpecularFactor", "double", "Number", "", 0.25
        }
    }
    Material: 4, "Material::second", "" {
        ShadingModel: "phong"
        Properties70: {
            P: "SpecularFactor", "double", "Number", "", 0.5
        }
    }
}
"""


def image(name, source="FILE", users=1, size=(8, 8), packed=None, fake=False, tiles=()):
    """Blender's, as far as it is asked."""
    return SimpleNamespace(filepath=str(name), source=source, users=users, use_fake_user=fake, size=size, packed_file=packed, library=None,
                           filepath_from_user=lambda: str(name), tiles=[SimpleNamespace(number=number) for number in tiles])


def blender(*images):
    return SimpleNamespace(data=SimpleNamespace(images=images), path=SimpleNamespace(abspath=lambda path, library: path))


class Obj(harness.CliTest):
    def lost(self, name, text):
        return import_materials.lost_obj_materials(self.write(name, text))

    def test_materials_without_a_file_are_lost(self):
        self.assertEqual(self.lost("o.obj", "mtllib other.mtl\n" + TRIANGLE), ["Material 'm' is left out: 'other.mtl' is not there."])
        self.assertEqual(self.lost("o.obj", "mtllib o.mtl\n" + TRIANGLE), ["Material 'm' is left out: 'o.mtl' is not there."])
        self.assertEqual(self.lost("o.obj", "usemtl of wood\nusemtl a\n"), ["Materials 'a', 'of wood' are left out: no file defines it."])
        self.assertEqual(self.lost("o.obj", "mtllib other.mtl\n" + TRIANGLE.replace("usemtl m\n", "")), [])

    def test_the_file_of_the_same_name_counts_whatever_is_named(self):
        self.write("o.mtl", "  newmtl m\r\nKd 1 1 1\n")
        self.assertEqual(self.lost("o.obj", "mtllib other.mtl\n" + TRIANGLE), [])
        self.assertEqual(self.lost("o.obj", TRIANGLE), [])
        self.assertEqual(self.lost("o.obj", "mtllib other.mtl\nusemtl gone\n"), ["Material 'gone' is left out: 'other.mtl' is not there."])

    def test_names_of_files_of_materials(self):
        self.write("one file.mtl", "newmtl m\n")
        self.write("a.mtl", "newmtl m\n")
        self.write("mtl/a.mtl", "newmtl m\n")
        for statement in ("mtllib one file.mtl", '\t mtllib "one file.mtl" ', "mtllib a.mtl\r", "mtllib mtl/a.mtl", "mtllib gone.mtl\nmtllib a.mtl"):
            self.assertEqual(self.lost("o.obj", f"{statement}\n{TRIANGLE}"), [], statement)
        self.assertEqual(self.lost("o.obj", "mtllib a.mtl not there.mtl\n" + TRIANGLE),
                         ["Material 'm' is left out: Blender does not read 'a.mtl', one of several in its line; 'not there.mtl' is not there."])
        self.assertEqual(self.lost("o.obj", "mtllibs a.mtl\n" + TRIANGLE), ["Material 'm' is left out: no file defines it."])

    def test_a_large_file_is_not_kept(self):
        path = self.write("o.obj", "mtllib gone.mtl\n" + "v 0.123456 0.123456 0.123456\n" * 200_000 + TRIANGLE)
        tracemalloc.start()
        self.addCleanup(tracemalloc.stop)
        self.assertIn("gone.mtl", " ".join(import_materials.lost_obj_materials(path)))
        self.assertLess(tracemalloc.get_traced_memory()[1], path.stat().st_size / 20)


class Pictures(harness.CliTest):
    def lost(self, *images):
        return import_materials.missing_pictures(blender(*images), self.folder / "s.blend")

    def test_pictures_that_are_not_there(self):
        gone, far = self.folder / "textures" / "gone.png", "/nonexistent/far.png"
        self.assertEqual(self.lost(image(gone), image(gone), image(far)),
                         [f"Picture '{far}' is not there and is left out.", "Picture 'textures/gone.png' is not there and is left out."])

    def test_pictures_that_nothing_shows(self):
        gone = self.folder / "gone.png"
        self.assertEqual(self.lost(image(gone, users=0), image(gone, fake=True), image(""), image(gone, "GENERATED"), image(gone, "VIEWER"),
                                   image(gone, packed=b"")), [])
        self.assertEqual(len(self.lost(image(gone, users=2, fake=True))), 1)

    def test_tiles(self):
        self.write("t.1001.png", b"")
        self.assertEqual(self.lost(image(self.folder / "t.<UDIM>.png", "TILED", tiles=(1001, 1012))), ["Picture 't.1012.png' is not there and is left out."])

    def test_pictures_that_cannot_be_read(self):
        damaged = self.write("damaged.png", b"nothing")
        self.assertEqual(self.lost(image(damaged, size=(0, 0))), ["Picture 'damaged.png' cannot be read and is left out."])
        self.assertEqual(self.lost(image(damaged)), [])


class Fbx(harness.CliTest):
    def surfaces(self, content):
        return import_materials.fbx_surfaces(self.write("s.fbx", content))

    def test_text_by_any_indentation(self):
        expected = "by hand", {"first": ("lambert", 0.25), "second": ("phong", 0.5)}
        for indentation in ("    ", "\t", "  ", ""):
            with self.subTest(indentation):
                text = FBX.replace("    ", indentation)
                self.assertEqual(self.surfaces(text), expected)
                self.assertEqual(self.surfaces(text.replace("\n", "\r\n")), expected)

    def test_files_that_are_damaged_state_nothing(self):
        """Without Blender its parser is not there; with a damaged file it fails in many ways."""
        head = b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400)
        self.assertEqual(self.surfaces(head), ("", {}))
        self.assertEqual(self.surfaces(FBX.replace("0.25", "e")), ("", {}))
        errors = [struct.error, zlib.error, IndexError, AssertionError, KeyError, MemoryError]
        for error in errors:
            with self.subTest(error.__name__):
                def parse(path, error=error):
                    raise error("damaged")
                sys.modules["io_scene_fbx"] = SimpleNamespace(parse_fbx=SimpleNamespace(parse=parse))
                self.addCleanup(sys.modules.pop, "io_scene_fbx", None)
                self.assertEqual(self.surfaces(head), ("", {}))


if __name__ == "__main__":
    harness.main()
