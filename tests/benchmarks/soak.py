#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Harms runs at random, and checks that nothing is lost and nothing wrong is joined.

    GAZETRACE=build/bin/gazetrace python3 tests/benchmarks/soak.py --seconds 3600 --seed 1

Every round takes a way to render a short sequence (one run, chunks, a farm of this machine) or to measure a sweep (by one process, and in chunks), and harms it
several times: signals at random moments, files that are cut, changed, swapped or removed, a folder that is removed, a disk
that is full, inputs that change. After every fault each file under a final name must be a whole one, unless this script damaged
it, and what `merge` accepts must be right. In the end the way is gone to its end, by --resume where there is that, and the
pictures, and a sweep's tables but for the times, must be those of a run that nothing happened to. A sweep's `state.json`, which
says whose folder it is, is left alone: a damaged one is refused. The seed of a round is printed with what went wrong;
--seed N --rounds 1 repeats it, apart from the moments of signals."""

import argparse
import collections
import csv
import json
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "cli"))
import gliding_job  # noqa: E402
import harness  # noqa: E402
from farm_test import SWEEP_TOML  # noqa: E402
from sweep_chunks_test import TIMES  # noqa: E402

FRAMES = 6
RENDER = ["render", "--config", "job.toml", "--resume", "--quiet", "--grace", "50ms"]


SWEEP = SWEEP_TOML.replace("repeats = 1", 'repeats = 1\nbaselines = ["uniform-reference-rate", "equal-samples", "low-resolution"]')


class Way:
    """How a sequence is rendered: steps in order, each of which can be done again, and what is added to the job."""

    sides = ("f.run*.json", "f.timing*.csv", "f.run*.files", "chunks*.json")  # files beside the pictures

    def __init__(self, name, more, steps):
        self.name, self.more, self.steps = name, more, steps

    def pictures(self, out):
        return gliding_job.pictures(out)

    def listed(self, out):
        """Files that a record or a journal vouches for: what else is damaged cannot be known."""
        names = set()
        for path in out.glob("f.run*"):
            try:
                if path.suffix == ".json":
                    names.update(json.loads(path.read_text()).get("files", {}))
                elif path.suffix == ".files":
                    names.update(line.split(" ", 3)[3] for line in path.read_text().splitlines() if line.count(" ") >= 3)
            except (OSError, ValueError):
                continue
        return sorted(name for name in names if (out / name).is_file())

    def table(self, out):
        """What a table must say besides the pictures."""
        return len((out / "f.timing.csv").read_text().splitlines())


class SweepWay(Way):
    """How a sweep is measured."""

    sides = ("runs/*.json", "references/*/*.json", "results.*", "methods.txt", "chunks*.json")

    def pictures(self, out):
        return {str(path.relative_to(out)): path.read_bytes() for folder in ("frames", "references")
                for path in sorted((out / folder).rglob("*")) if path.suffix in (".exr", ".png") and "scrambling" not in str(path)}

    def listed(self, out):
        names = set()
        for path in out.rglob("*.json"):
            try:
                names.update(json.loads(path.read_text()).get("files", {}))
            except (OSError, ValueError, AttributeError):
                continue
        return sorted(name for name in names if (out / name).is_file())

    def table(self, out):
        with open(out / "results.csv", newline="", encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if key not in TIMES} for row in csv.DictReader(file)]


def ways():
    chunks = [[*RENDER, "--chunk", f"{number}/3"] for number in (1, 2, 3)]
    sweep = ["sweep", "plan.toml", "-o", "out", "--quiet"]
    return [
        Way("one run", "", [RENDER]),
        Way("chunks", "", [*chunks, ["merge", "out", "--overwrite"]]),
        Way("local farm", "", [["farm", "farm.toml", "--chunks", "2", "--processes", "2", "--threads", "1", "--retries", "2"]]),
        SweepWay("sweep", "", [sweep]),
        SweepWay("sweep in chunks", "", [[*sweep, "--chunk", "1/2"], [*sweep, "--chunk", "2/2"], ["sweep", "merge", "plan.toml", "-o", "out"]]),
    ]


class Trouble(Exception):
    pass


class Soak:
    def __init__(self, folder, size):
        self.folder = Path(folder)
        self.size = size
        self.faults = collections.Counter()
        self.outcomes = collections.Counter()
        self.rounds = 0
        self.references = {}
        gliding_job.write_inputs(self.folder)

    @property
    def out(self):
        return self.folder / "out"

    def program(self, words, preparation=None):
        return subprocess.Popen([harness.PROGRAM, *words], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                preexec_fn=preparation)

    def run(self, words, preparation=None):
        process = self.program(words, preparation)
        text = process.communicate(timeout=300)[0].decode(errors="replace")
        return process.returncode, text

    def prepare(self, way):
        text = gliding_job.job_toml(self.size, "16, 8, 4", FRAMES, "out", "threads = 1\n" + way.more)
        for name in ("job.toml", "farm.toml"):
            (self.folder / name).write_text(text)
        (self.folder / "plan.toml").write_text(SWEEP)
        self.way = way
        shutil.rmtree(self.out, ignore_errors=True)

    def reference(self, way):
        if way.name not in self.references:
            begin = time.monotonic()
            for step in way.steps:
                code, text = self.run(step)
                if code != 0:
                    raise Trouble(f"without any fault: {step}: {text}")
            self.references[way.name] = (self.pictures(), time.monotonic() - begin, way.table(self.out))
            shutil.rmtree(self.out)
        return self.references[way.name]

    def pictures(self):
        return self.way.pictures(self.out)

    # ---- Faults. Each returns its name, or None where it cannot be done now.

    def end_by_signal(self, rng, step, typical_s):
        kind = rng.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGKILL, signal.SIGUSR1])
        process = self.program(step)
        time.sleep(rng.uniform(0, 1.2) * typical_s)
        ended_before = process.poll() is not None
        process.send_signal(kind)
        text = process.communicate(timeout=300)[0].decode(errors="replace")
        if kind == signal.SIGKILL and step[0] == "farm":
            self.wait_for_orphans()
        code = process.returncode
        self.outcomes[f"signal {kind.name}: exit {code}"] += 1
        if not ended_before and code not in (0, 2, 4, -signal.SIGKILL, -kind):
            raise Trouble(f"{kind.name} ended {step} with {code}: {text}")
        return f"signal {kind.name}"

    def wait_for_orphans(self):
        """Tasks of a farm whose runner was killed end by themselves."""
        end = time.monotonic() + 60
        while time.monotonic() < end and gliding_job.processes_in(self.folder):
            time.sleep(0.05)

    def damage(self, rng, damaged):
        names = [name for name in self.way.listed(self.out) if name not in damaged]
        if not names:
            return None
        name = rng.choice(names)
        path = self.out / name
        content = bytearray(path.read_bytes())
        kind = rng.choice(["cut", "changed", "emptied", "swapped", "removed"])
        if kind == "cut":
            path.write_bytes(content[:rng.randrange(len(content))])
        elif kind == "changed":
            content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
            path.write_bytes(content)
        elif kind == "emptied":
            path.write_bytes(b"")
        elif kind == "swapped":
            others = [other for other in names if other != name and Path(other).suffix == path.suffix]
            if not others:
                return None
            shutil.copyfile(self.out / rng.choice(others), path)
        else:
            path.unlink()
        damaged.add(name)
        return f"file {kind}"

    def remove_side_file(self, rng):
        sides = [path for pattern in self.way.sides for path in self.out.glob(pattern)]
        if not sides:
            return None
        path = rng.choice(sorted(sides))
        if rng.random() < 0.5:
            path.unlink()
        else:
            content = path.read_bytes()
            path.write_bytes(content[:rng.randrange(len(content) + 1)])
        return f"side file {path.name.split('.')[0].split('-')[0]}"

    def fill_disk(self, rng, step):
        limit = rng.choice([200, 1000, 3000, 10000])
        code, text = self.run(step, lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
        self.outcomes[f"disk full: exit {code}"] += 1
        if code not in (0, 2, 3):
            raise Trouble(f"a full disk ended {step} with {code}: {text}")
        return "disk full"

    def change_input(self, step, reference):
        """Another gaze log: finished frames must not be rendered over."""
        before = self.pictures()
        if not any(reference.get(name) == content for name, content in before.items()):
            return None
        log = self.folder / "log.csv"
        text = log.read_text()
        log.write_text(text.replace("0.2000,0.5", "0.2500,0.5", 1))
        try:
            code, said = self.run(step)
        finally:
            log.write_text(text)
        if self.pictures() != before:
            raise Trouble(f"a changed input replaced finished frames: exit {code}, {said}")
        self.outcomes[f"changed input: exit {code}"] += 1
        return "changed input"

    # ---- Checks

    def check_files(self, reference, damaged, after):
        for name, content in self.pictures().items():
            if name not in damaged and content != reference.get(name):
                raise Trouble(f"after {after}: {name} has {len(content)} bytes and is not the picture")

    def check_merge(self, way, reference, after):
        if "merge" not in way.steps[-1]:
            return
        code, text = self.run(way.steps[-1])
        if code == 0 and (self.pictures() != reference or way.table(self.out) != self.references[way.name][2]):
            raise Trouble(f"after {after}: merge accepted what is wrong or not whole: {text}")
        self.outcomes[f"merge in between: exit {code}"] += 1

    def finish(self, way, reference, damaged):
        for _ in range(4):
            codes = []
            for step in way.steps:
                code, text = self.run(step)
                if code == 2 and "would render over" in text and damaged:
                    # A changed header may look like that of another job, whose work is not lost without a word.
                    self.outcomes["a changed header looks like another job's: refused, then --overwrite"] += 1
                    code, text = self.run([*step, "--overwrite"])
                codes.append((code, text))
            if all(code == 0 for code, _ in codes):
                break
        else:
            raise Trouble(f"it did not go on: {codes}")
        if self.pictures() != reference:
            wrong = sorted(name for name in set(reference) | set(self.pictures()) if reference.get(name) != self.pictures().get(name))
            raise Trouble(f"the pictures differ from those of an undisturbed run: {wrong}")
        if way.table(self.out) != self.references[way.name][2]:
            raise Trouble(f"the table differs: {way.table(self.out)}")

    def round(self, seed):
        rng = random.Random(seed)
        way = rng.choice(ways())
        self.prepare(way)
        reference, typical_s, _ = self.reference(way)
        done = []
        damaged = set()
        sides_gone = False
        for _ in range(rng.randint(3, 9)):
            step = rng.choice(way.steps)
            kind = rng.choice(["signal"] * 4 + ["damage"] * 3 + ["side", "disk", "input", "folder"])
            if kind == "folder" and rng.random() > 0.3:
                kind = "signal"
            name = None
            if kind == "signal":
                name = self.end_by_signal(rng, step, typical_s / len(way.steps))
            elif kind == "damage" and not sides_gone:
                name = self.damage(rng, damaged)
            elif kind == "side" and not damaged:
                name = self.remove_side_file(rng)
                sides_gone = sides_gone or name is not None
            elif kind == "disk":
                name = self.fill_disk(rng, step)
            elif kind == "input" and not damaged and not sides_gone and RENDER in way.steps:
                self.run(RENDER)  # so that there are finished frames
                name = self.change_input(RENDER, reference)
            elif kind == "folder":
                shutil.rmtree(self.out, ignore_errors=True)
                damaged, sides_gone, name = set(), False, "folder removed"
            if name is None:
                continue
            done.append(name)
            self.faults[name] += 1
            # What a run has found damaged it has made again; to know which, each damaged file is looked at.
            damaged = {file for file in damaged if (self.out / file).exists() and (self.out / file).read_bytes() != reference.get(file)} | \
                      {file for file in damaged if not (self.out / file).exists()}
            self.check_files(reference, damaged, done)
            if rng.random() < 0.3 and not sides_gone:
                self.check_merge(way, reference, done)
        try:
            self.finish(way, reference, damaged)
        except Trouble as trouble:
            raise Trouble(f"{way.name}, after {done}: {trouble}") from trouble
        self.rounds += 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=3600)
    parser.add_argument("--rounds", type=int, default=10**9)
    parser.add_argument("--seed", type=int, default=int(time.time()))
    parser.add_argument("--size", default="32x18")
    arguments = parser.parse_args()
    print(f"seeds from {arguments.seed}", flush=True)
    troubles = []
    end = time.monotonic() + arguments.seconds
    with tempfile.TemporaryDirectory(prefix="gazetrace_soak_") as folder:
        soak = Soak(folder, arguments.size)
        seed = arguments.seed
        while time.monotonic() < end and soak.rounds + len(troubles) < arguments.rounds:
            try:
                soak.round(seed)
            except Trouble as trouble:
                troubles.append(f"seed {seed}: {trouble}")
                print("WRONG:", troubles[-1], flush=True)
            seed += 1
    print(f"{sum(soak.faults.values())} faults in {soak.rounds + len(troubles)} rounds, {len(troubles)} of them wrong")
    for counts in (soak.faults, soak.outcomes):
        print("  " + "; ".join(f"{name}: {count}" for name, count in sorted(counts.items())))
    return 1 if troubles else 0


if __name__ == "__main__":
    sys.exit(main())
