# SPDX-License-Identifier: Apache-2.0
"""Packs the wheel (cmake --workflow --preset wheel): the program as it is installed lies in the package, with the libraries of
Debian that it needs and the licences of all of them.

    gazetrace/            the Python package; _core for each Python; bin/, lib/ and share/ as in an installation
    gazetrace_report/     reports and imports
    gazetrace_blender/    the add-on for Blender, which the imports use
    gazetrace.libs/       the libraries, as auditwheel names them
    bin/gazetrace         a script that starts the program, beside those that pip makes for the reports
    share/man             the manual pages
"""

import argparse
import re
import shutil
import subprocess
import sys
import tomllib
from email.message import Message
from pathlib import Path

PLATFORM = "manylinux_2_36_x86_64"  # Debian 12's C library
# What is compiled into the binaries, so that no library tells of it: Debian's packages of headers.
HEADERS = ["nlohmann-json3-dev", "libcli11-dev", "libtomlplusplus-dev", "robin-map-dev"]

LAUNCHER = """#!/bin/sh
# gazetrace of a wheel. The program lies in the Python package; what it starts and looks for on the PATH lies here.
file=$0
[ ! -L "$file" ] || file=$(readlink -f "$file")
here=$(cd "${file%/*}" && pwd -P) || exit 3
for package in "$here"/../lib/python3*/site-packages/gazetrace "$here"/../lib/python3*/dist-packages/gazetrace "$here"/../gazetrace; do
  if [ -x "$package/bin/gazetrace" ]; then
    PATH=$here:$PATH exec "$package/bin/gazetrace" "$@"
  fi
done
echo "gazetrace: error: $here: no Python package of gazetrace lies beside it; install the wheel again" >&2
exit 3
"""


def run(*words, **more):
    return subprocess.run([str(word) for word in words], check=True, text=True, capture_output=True, **more).stdout


def copy_tree(source, target, *suffixes):
    for path in sorted(source.rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts and (not suffixes or path.suffix in suffixes or path.name.startswith("LICENSE")):
            place = target / path.relative_to(source)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, place)


def copy_stripped(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    run("strip", "--strip-unneeded", "-o", target, source)
    target.chmod(0o755)


def stage(arguments, tree):
    sources, package = arguments.sources, tree / "gazetrace"
    copy_tree(sources / "python/gazetrace", package)
    copy_tree(sources / "python/gazetrace_report", tree / "gazetrace_report")
    copy_tree(sources / "blender/gazetrace_blender", tree / "gazetrace_blender")
    pythons = [re.search(r"cpython-(\d)(\d+)", module.name).groups() for module in arguments.modules]
    names = ", ".join(f"{major}.{minor}" for major, minor in pythons)
    (package / "_build.py").write_text(f'# SPDX-License-Identifier: Apache-2.0\ndistribution = "Debian 12 for Python {names}"\n')
    for module in arguments.modules:
        copy_stripped(module, package / module.name)
    copy_stripped(arguments.program, package / "bin/gazetrace")
    copy_stripped(arguments.pictures, package / "lib" / arguments.pictures.name)
    share = package / "share/gazetrace"
    for name in ("examples/example.toml", "examples/demo.toml", "scenes/README.md"):
        (share / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(sources / name, share / name)
    copy_tree(sources / "scenes/courtyard", share / "scenes/courtyard")
    copy_tree(sources / "gazelogs", share / "gazelogs", ".csv", ".md")
    data = tree / f"gazetrace-{arguments.version}.data"
    (data / "scripts").mkdir(parents=True)
    (data / "scripts/gazetrace").write_text(LAUNCHER)
    (data / "scripts/gazetrace").chmod(0o755)
    shell, shared = arguments.build / "shell", data / "data/share"
    copy_tree(shell / "man1", shared / "man/man1")
    for name, folder in (("gazetrace", "bash-completion/completions"), ("_gazetrace", "zsh/site-functions"),
                         ("gazetrace.fish", "fish/vendor_completions.d")):
        (shared / folder).mkdir(parents=True)
        shutil.copy(shell / name, shared / folder / name)
    return pythons


def write_metadata(arguments, tree, pythons):
    """As pyproject.toml states it, which pip reads for a build of the sources."""
    with open(arguments.sources / "pyproject.toml", "rb") as file:
        project = tomllib.load(file)["project"]
    info = tree / f"gazetrace-{arguments.version}.dist-info"
    info.mkdir()
    message = Message()
    message["Metadata-Version"] = "2.1"
    message["Name"], message["Version"], message["Summary"] = project["name"], arguments.version, project["description"]
    message["License"], message["Requires-Python"] = project["license"]["text"], project["requires-python"]
    for classifier in project["classifiers"]:
        message["Classifier"] = classifier
    for requirement in project["dependencies"]:
        message["Requires-Dist"] = requirement
    for extra, requirements in project["optional-dependencies"].items():
        message["Provides-Extra"] = extra
        for requirement in requirements:
            message["Requires-Dist"] = f'{requirement}; extra == "{extra}"'
    message["Description-Content-Type"] = "text/markdown"
    readme = (arguments.sources / project["readme"]).read_text(encoding="utf-8")
    (info / "METADATA").write_text(f"{message}{readme}", encoding="utf-8")
    scripts = "".join(f"{name} = {place}\n" for name, place in project["scripts"].items())
    (info / "entry_points.txt").write_text(f"[console_scripts]\n{scripts}")
    tags = "".join(f"Tag: cp{major}{minor}-cp{major}{minor}-linux_x86_64\n" for major, minor in pythons)
    (info / "WHEEL").write_text(f"Wheel-Version: 1.0\nGenerator: gazetrace\nRoot-Is-Purelib: false\n{tags}")
    return info


def write_licences(arguments, tree, libraries, info):
    """Of gazetrace, of what is compiled in, and of each library's package."""
    folder = info / "licenses"
    folder.mkdir()
    shutil.copy(arguments.sources / "LICENSE", folder / "gazetrace")
    [oiio] = arguments.build.glob("openimageio/openimageio-*/LICENSE.md")
    shutil.copy(oiio, folder / "openimageio")
    shutil.copy(oiio.with_name("THIRD-PARTY.md"), folder / "openimageio.third-party")
    [pybind11] = Path(sys.prefix).glob("lib/python*/site-packages/pybind11-*.dist-info/**/LICENSE")
    shutil.copy(pybind11, folder / "pybind11")
    packages = {}
    for library in libraries:
        # The loader's folder may be a link to the one that the package names.
        owner = next(line for place in (library, Path(str(library).removeprefix("/usr")))
                     for line in [subprocess.run(["dpkg", "-S", place], text=True, capture_output=True, check=False).stdout] if line)
        packages.setdefault(owner.split(":")[0], []).append(library.name)
    rows = [f"{package}: {', '.join(sorted(files))}" for package, files in sorted(packages.items())]
    (folder / "README").write_text("The files of gazetrace.libs are those of these packages of Debian, whose licences lie here under the "
                                   "packages' names, unchanged but for their names and search paths:\n\n" + "\n".join(rows) +
                                   f"\n\nCompiled in: openimageio, pybind11, {', '.join(HEADERS)}.\n")
    common = set()
    for package in [*packages, *HEADERS]:
        text = Path("/usr/share/doc", package, "copyright").read_text(encoding="utf-8", errors="replace")
        (folder / package).write_text(text, encoding="utf-8")
        common |= set(re.findall(r"/usr/share/common-licenses/([\w.+-]*\w)", text))
    for name in sorted(common):
        if (text := Path("/usr/share/common-licenses", name)).is_file():
            shutil.copy(text, folder / f"common-licenses.{name}")
    return rows


def libraries_of(tree):
    """What auditwheel will take in: every library that the loader finds, less what each Linux has."""
    found = set()
    for path in [tree / "gazetrace/bin/gazetrace", *tree.glob("gazetrace/lib/*.so"), *tree.glob("gazetrace/_core*.so")]:
        for name, place in re.findall(r"(\S+) => (/\S+)", run("ldd", path)):
            if not re.match(r"lib(c|m|dl|rt|pthread|gcc_s|stdc\+\+|z|expat)\.so", name):
                found.add(Path(place).resolve())
    return sorted(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("sources", "build", "program", "pictures"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--version", required=True)
    parser.add_argument("--modules", type=Path, nargs="+", required=True)
    arguments = parser.parse_args()
    tree, made = arguments.build / "staged", arguments.build / "packed"
    for folder in (tree, made):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
    pythons = stage(arguments, tree)
    info = write_metadata(arguments, tree, pythons)
    write_licences(arguments, tree, libraries_of(tree), info)
    tools = Path(sys.executable).parent
    run(tools / "wheel", "pack", tree, "-d", made)
    [raw] = made.glob("*.whl")
    for old in arguments.build.glob("gazetrace-*.whl"):
        old.unlink()
    run(tools / "auditwheel", "repair", "--plat", PLATFORM, "--only-plat", "-w", arguments.build, raw,
        env={"PATH": f"{tools}:/usr/bin:/bin"})
    [wheel] = arguments.build.glob("gazetrace-*.whl")
    print(f"{wheel}: {wheel.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
