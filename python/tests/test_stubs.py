# SPDX-License-Identifier: Apache-2.0
import ast
import importlib.util
import inspect
import unittest

import gazetrace
from support import ROOT, TestCase


class StubsTest(TestCase):
    def test_stubs_follow_the_schemas(self):
        spec = importlib.util.spec_from_file_location("write_stubs", ROOT / "python/tools/write_stubs.py")
        writer = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(writer)
        for name, stub in writer.STUBS.items():
            written = (ROOT / "python/gazetrace" / name).read_text(encoding="utf-8")
            self.assertEqual(stub(), written, f"{name} is out of date: run python/tools/write_stubs.py")

    def test_stubs_name_everything_that_is_public(self):
        tree = ast.parse((ROOT / "python/gazetrace/__init__.pyi").read_text(encoding="utf-8"))
        stubs = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
        for name in set(gazetrace.__all__) - {"metrics"}:
            self.assertIn(name, stubs)
            held = getattr(gazetrace, name)
            if inspect.isclass(held) and held.__module__.startswith("gazetrace.") and held.__module__ != "gazetrace._core":
                members = {getattr(node, "name", None) or getattr(getattr(node, "target", None), "id", None)
                           for node in stubs[name].body}
                own = {member for member in vars(held) if not member.startswith("_")}
                self.assertLessEqual(own - {"with_traceback", "count", "index"}, members, name)


if __name__ == "__main__":
    unittest.main()
