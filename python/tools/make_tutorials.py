# SPDX-License-Identifier: Apache-2.0
"""Runs tutorials from the root of the repository, and makes of each a page of the manual, with its pictures, and a notebook.

    python3 python/tools/make_tutorials.py docs/tutorials/*.py [-o FOLDER] [--small]

A tutorial is a script in the percent format, which editors run cell by cell: `# %% [markdown]` begins text, `# %%` code. A
page shows under each cell what it prints, the value of its last line, and its figures. A cell `# %% needs: MODULE` is
run where that module is installed. `x = 9  # small: 1` is `x = 1` with --small, as the tests run it."""

import argparse
import ast
import contextlib
import importlib.util
import io
import json
import os
import re
from pathlib import Path

import matplotlib.pyplot as plt
import pandas
from gazetrace_report.drawing import STYLE

ROOT = Path(__file__).resolve().parents[2]
plt.switch_backend("agg")
plt.show = lambda *_, **__: None  # figures are shown in the page
pandas.set_option("display.width", 120, "display.max_columns", 20, "display.max_colwidth", 40)


def cells_of(text, small=False):
    """Kind ("markdown" or "code"), needed module and source of each cell."""
    text = re.sub(r"^(.*? = ).*?  # small: (.*)$" if small else r"^(.*? = )(.*?)  # small: .*$", r"\1\2", text, flags=re.M)
    heads = re.split(r"^# %%(.*)\n", text, flags=re.M)[1:]
    for head, source in zip(heads[::2], heads[1::2]):
        if "[markdown]" in head:
            yield "markdown", "", re.sub(r"^# ?", "", source, flags=re.M).strip()
        else:
            yield "code", head.partition("needs: ")[2].strip(), source.strip()


def run(source, names, place):
    """The value of the last line, as in a notebook."""
    body = ast.parse(source).body
    last = body.pop().value if body and isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), place, "exec"), names)
    return last and eval(compile(ast.Expression(last), place, "eval"), names)


@plt.style.context(["default", str(STYLE), {"savefig.facecolor": "white", "text.parse_math": True, "axes.grid": False}])
def page_of(path, folder, small=False):
    """Runs a tutorial and writes its page into a folder, with its pictures beside it."""
    names, page, pictures = {"__name__": "__main__"}, [], 0

    def show(ending, write):
        nonlocal pictures
        pictures += 1
        write(folder / f"{path.stem}_{pictures}.{ending}")
        page.append(f"![]({path.stem}_{pictures}.{ending})")

    for number, (kind, needed, source) in enumerate(cells_of(path.read_text(encoding="utf-8"), small), 1):
        if kind == "markdown":
            page.append(source)
            continue
        page.append(f"```python\n{source}\n```")
        if needed and not importlib.util.find_spec(needed):
            page.append(f"*Not run: {needed} is not installed here.*")
            continue
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            value = run(source, names, f"{path.name}, cell {number}")
            if value is not None and not hasattr(value, "_repr_png_"):
                print(value)
        if printed.getvalue():
            page.append(f"```text\n{printed.getvalue().rstrip()}\n```")
        if hasattr(value, "_repr_png_"):
            show("png", lambda file: file.write_bytes(value._repr_png_()))
        for figure in map(plt.figure, plt.get_fignums()):
            show("svg", figure.savefig)
        plt.close("all")
    (folder / f"{path.stem}.md").write_text("\n\n".join(page) + "\n", encoding="utf-8")
    more = {"markdown": {}, "code": {"execution_count": None, "outputs": []}}
    cells = [{"cell_type": kind, "id": f"cell-{i}", "metadata": {}, "source": source, **more[kind]}
             for i, (kind, _, source) in enumerate(cells_of(path.read_text(encoding="utf-8")))]
    (folder / f"{path.stem}.ipynb").write_text(json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}, indent=1))
    return pictures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scripts", nargs="+", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs/tutorials")
    parser.add_argument("--small", action="store_true", help="takes the values behind '# small:'")
    arguments = parser.parse_args()
    folder, scripts = arguments.output.resolve(), [script.resolve() for script in arguments.scripts]
    folder.mkdir(parents=True, exist_ok=True)
    os.chdir(ROOT)
    for script in scripts:
        print(f"{folder / script.stem}.md: {page_of(script, folder, arguments.small)} pictures")


if __name__ == "__main__":
    main()
