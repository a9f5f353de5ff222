# SPDX-License-Identifier: Apache-2.0
"""Every command of README.md, of the manual (docs/) and of examples/README.md, top to bottom, as a reader would type it.

A document's ```sh blocks run in one shell, in a folder of their own that holds blender/, examples/, scenes/ and gazelogs/, with the
program on the PATH as `gazetrace` and as build/release/bin/gazetrace. HTML comments right above a block say what is special:

  <!-- not run by the tests: REASON -->         the block is left out
  <!-- run by the tests from: WORDS -->         what stands before these words is left out
  <!-- reduced: --size 64x36 --frames 1-2 -->   every `gazetrace render` of the block gets these options, in place of its own
  <!-- needs: ffmpeg -->                        the block is left out where there is no such program
  <!-- prints -->                               above a ```text block: the commands right before it print these lines
"""

import os
import re
import shutil
import stat
import subprocess
import sys
import time
import unittest

import harness

WRAPPER = """#!{python}
import os, sys
arguments = sys.argv[1:]
reduced = os.environ.get("GAZETRACE_REDUCED", "").split()
if reduced and arguments[:1] == ["render"]:
    for name in reduced[::2]:
        while name in arguments:
            at = arguments.index(name)
            del arguments[at:at + 2]
    arguments += reduced
os.execv({program!r}, ["gazetrace"] + arguments)
"""

DIRECTIVE = re.compile(r"<!-- (not run by the tests: (?P<skip>.+)|run by the tests from: (?P<start>.+)|"
                       r"reduced: (?P<reduced>.+)|needs: (?P<needs>\S+)|(?P<prints>prints)|test command) -->")


class Block:
    def __init__(self, language, line):
        self.language, self.line, self.text = language, line, ""
        self.skip = self.start = self.reduced = self.needs = None
        self.prints = False


def blocks_of(path):
    """The fenced blocks of a document with what the comments right above them say."""
    blocks, comments, block = [], [], None
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if block is not None:
            if line == "```":
                blocks.append(block)
                block, comments = None, []
            else:
                block.text += line + "\n"
        elif line.startswith("```"):
            block = Block(line[3:].strip(), number)
            for place, comment in comments:
                found = DIRECTIVE.fullmatch(comment)
                if found is None:
                    raise ValueError(f"{path}:{place}: the tests do not know '{comment}'")
                for name, value in found.groupdict().items():
                    if value is not None:
                        setattr(block, name, value)
        elif line.startswith("<!--"):
            comments.append((number, line))
        else:
            comments = []
    return blocks


class Documents(harness.CliTest):
    def setUp(self):
        super().setUp()
        (self.folder / "box.gltf").unlink()
        for name in ("blender", "examples", "scenes", "gazelogs"):
            shutil.copytree(harness.SOURCE / name, self.folder / name, symlinks=True)
        for place in ("path", "build/release/bin"):
            wrapper = self.folder / place / "gazetrace"
            wrapper.parent.mkdir(parents=True)
            wrapper.write_text(WRAPPER.format(python=sys.executable, program=harness.PROGRAM), encoding="utf-8")
            wrapper.chmod(wrapper.stat().st_mode | stat.S_IXUSR)

    def run_document(self, name):
        path = harness.SOURCE / name
        script, printed, ran = ["set -eu -o pipefail"], [], []
        for block in blocks_of(path):
            if block.language == "text" and block.prints:
                self.assertTrue(ran, f"{name}:{block.line}: nothing was run before it")
                printed.append((ran[-1], block))
            if block.language != "sh" or block.skip or (block.needs and not shutil.which(block.needs)):
                continue
            text = block.text[block.text.index(block.start):] if block.start else block.text
            script += [f"export GAZETRACE_REDUCED='{block.reduced or ''}'", f"echo {name}:{block.line} >.block",
                       "{", text.rstrip("\n"), f"}} >.stdout.{block.line}"]
            ran.append(block.line)
        shutil.rmtree(self.folder / "out", ignore_errors=True)  # of the page before
        begin = time.monotonic()
        environment = {key: value for key, value in os.environ.items() if key != "OCIO"}
        environment["PATH"] = f"{self.folder / 'path'}:{environment['PATH']}"
        result = subprocess.run(["bash", "-c", "\n".join(script)], cwd=self.folder, capture_output=True, text=True, timeout=300,
                                env=environment, check=False)
        print(f"{name}: {len(ran)} blocks in {time.monotonic() - begin:.1f} s")
        if result.returncode != 0:
            self.fail(f"{(self.folder / '.block').read_text().strip()} ended with code {result.returncode}:\n{result.stderr[-4000:]}")
        # No picture of the manual is night; those that show how dark ones are told of would be left out.
        self.assertNotRegex(result.stderr, "pictures (is|are) dark", name)
        for line, block in printed:
            output = (self.folder / f".stdout.{line}").read_text(encoding="utf-8")
            self.assertIn(block.text, output, f"{name}:{block.line}: the commands at line {line} print something else")
        return len(ran)

    def test_readme(self):
        if not shutil.which("ffmpeg"):
            self.skipTest("ffmpeg is not here")
        self.assertEqual(self.run_document("README.md"), 1)
        self.assertGreater((self.folder / "out/example/gaze.mp4").stat().st_size, 1000)

    def test_examples(self):
        self.assertEqual(self.run_document("examples/README.md"), 1)

    def test_manual(self):
        pages = sorted((harness.SOURCE / "docs").glob("*.md"))
        self.assertGreaterEqual(len(pages), 10)
        for page in pages:
            with self.subTest(page=page.name):
                self.run_document(f"docs/{page.name}")

    def test_comments_are_understood(self):
        """A misspelt comment must not let a command run at full size, or not at all."""
        page = self.write("page.md", "<!-- reduce: --size 8x8 -->\n```sh\ntrue\n```\n")
        with self.assertRaises(ValueError):
            blocks_of(page)


if __name__ == "__main__":
    harness.main()
