#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Opens a report in headless Chromium from its file with the network cut off, uses every control, and fails on any
message on the console, any request, and any control without the effect that it names. By hand, not in CI.

    tests/benchmarks/report_in_browser.py report.html [--shots DIR]

Needs Debian's chromium and chromium-driver; talks WebDriver to it (W3C) with nothing but Python."""

import argparse
import base64
import json
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

SIZES = {"desk": (1280, 800, False), "phone": (390, 844, True)}
KEYS = {"ArrowLeft": "\ue012", "ArrowRight": "\ue014", "Tab": "\ue004"}


class Browser:
    def __init__(self, driver, chromium, width, height, mobile, dark):
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.profile = tempfile.mkdtemp(prefix="report_browser_")
        self.process = subprocess.Popen([driver, f"--port={self.port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        options = {
            "binary": chromium,
            "args": ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={self.profile}", f"--window-size={width},{height}"],
        }
        capabilities = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"}}
        for _ in range(100):
            try:
                session = self.call("POST", "/session", {"capabilities": {"alwaysMatch": capabilities}}, base="")
                break
            except urllib.error.URLError as problem:
                if isinstance(problem, urllib.error.HTTPError):
                    raise SystemExit(problem.read().decode())
                time.sleep(0.2)
        self.base = "/session/" + session["sessionId"]
        self.cdp("Network.enable", {})
        self.cdp("Network.emulateNetworkConditions", {"offline": True, "latency": 0, "downloadThroughput": 0, "uploadThroughput": 0})
        self.cdp("Emulation.setDeviceMetricsOverride", {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": mobile})
        self.cdp("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]})

    def call(self, method, path, body=None, base=None):
        url = f"http://127.0.0.1:{self.port}{self.base if base is None else base}{path}"
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(url, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.loads(answer.read())["value"]

    def cdp(self, command, parameters):
        return self.call("POST", "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def run(self, script, *arguments):
        return self.call("POST", "/execute/sync", {"script": script, "args": list(arguments)})

    def element(self, selector):
        found = self.call("POST", "/element", {"using": "css selector", "value": selector})
        return next(iter(found.values()))

    def click(self, selector):
        self.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})", selector)
        self.call("POST", f"/element/{self.element(selector)}/click", {})

    def key(self, key):
        value = KEYS.get(key, key)
        self.call("POST", "/actions", {"actions": [{"type": "key", "id": "keys", "actions": [
            {"type": "keyDown", "value": value}, {"type": "keyUp", "value": value}]}]})

    def drag(self, selector, share):
        """From the middle of an element to a share of its width."""
        box = self.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'});"
                       "const b = document.querySelector(arguments[0]).getBoundingClientRect(); return [b.left, b.top, b.width, b.height]", selector)
        y = round(box[1] + box[3] / 2)
        point = [{"type": "pointerMove", "duration": 0, "x": round(box[0] + box[2] / 2), "y": y}, {"type": "pointerDown", "button": 0},
                 {"type": "pointerMove", "duration": 50, "x": round(box[0] + box[2] * share), "y": y}, {"type": "pointerUp", "button": 0}]
        self.call("POST", "/actions", {"actions": [{"type": "pointer", "id": "mouse", "parameters": {"pointerType": "mouse"}, "actions": point}]})

    def shot(self, path):
        path.write_bytes(base64.b64decode(self.call("GET", "/screenshot")))

    def console(self):
        return [entry for entry in self.call("POST", "/se/log", {"type": "browser"})]

    def requests(self):
        urls = []
        for entry in self.call("POST", "/se/log", {"type": "performance"}):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                urls.append(message["params"]["request"]["url"])
        return urls

    def close(self):
        try:
            self.call("DELETE", "")
        finally:
            self.process.terminate()
            self.process.wait()
            shutil.rmtree(self.profile, ignore_errors=True)


# The canvas' bytes, through a copy: reading the page's own canvas again and again makes Chromium warn on the console.
PIXELS = """const c = document.getElementById('canvas'), copy = document.createElement('canvas');
copy.width = c.width; copy.height = c.height;
const context = copy.getContext('2d', {willReadFrequently: true});
context.drawImage(c, 0, 0);
const d = context.getImageData(0, 0, c.width, c.height).data;"""


class Checks:
    def __init__(self, browser):
        self.browser, self.failed, self.passed = browser, [], 0

    def that(self, holds, what):
        if holds:
            self.passed += 1
        else:
            self.failed.append(what)
            print("  FAILED:", what)

    def pixels(self):
        """The canvas after it has been drawn, as a short text."""
        time.sleep(0.25)
        return self.browser.run(
            PIXELS + "let h = 2166136261; for (let i = 0; i < d.length; ++i) h = Math.imul(h ^ d[i], 16777619); return c.width + 'x' + c.height + ':' + (h >>> 0)")

    def changes(self, action, what, back=None):
        before = self.pixels()
        action()
        after = self.pixels()
        self.that(before != after, f"{what} changes the picture")
        if back:
            back()
            self.that(self.pixels() == before, f"{what} can be undone")


def value(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).value", selector)


def pressed(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).getAttribute('aria-pressed')", selector) == "true"


def choose(browser, selector, option):
    browser.run("const s = document.querySelector(arguments[0]); s.selectedIndex = arguments[1];"
                "s.dispatchEvent(new Event('change', {bubbles: true}))", selector, option)


def leave_controls(browser):
    browser.run("document.activeElement.blur(); document.getElementById('canvas').scrollIntoView({block: 'center', behavior: 'instant'})")


def use_diagrams(browser, checks):
    kinds = set(browser.run("return JSON.parse(document.getElementById('data').textContent).plots.map((plot) => plot.kind)"))
    drawn = set()
    for place in range(browser.run("return document.getElementById('plot-set').options.length")):
        choose(browser, "#plot-set", place)
        here = {kind for kind in ("pareto", "time", "bands")
                if browser.run("return document.querySelector(arguments[0] + ' svg') !== null", f"#plot-{kind}")}
        said = browser.run("const e = document.getElementById('plot-none'); return e.hidden ? '' : e.textContent")
        checks.that((here == kinds) == (said == ""), f"what is missing is said: {here} {said}")
        drawn |= here
    choose(browser, "#plot-set", 0)
    checks.that(drawn == kinds, f"every kind of diagram is drawn somewhere: {drawn}")
    for select in ("#plot-set", "#plot-row", "#plot-metric"):
        count = browser.run("return document.querySelector(arguments[0]).options.length", select)
        checks.that(count > 0, f"{select} offers something")
        before = browser.run("return document.getElementById('diagrams').innerHTML")
        if count > 1:
            first = browser.run("return document.querySelector(arguments[0]).selectedIndex", select)
            choose(browser, select, (first + 1) % count)
            checks.that(browser.run("return document.getElementById('diagrams').innerHTML") != before, f"{select} changes the diagrams")
            choose(browser, select, first)
            checks.that(browser.run("return document.getElementById('diagrams').innerHTML") == before, f"{select} can be undone")


def offers(browser, selector):
    return browser.run("return document.querySelector(arguments[0]).offsetParent !== null", selector)


def use_viewer(browser, checks):
    frames = int(browser.run("return document.getElementById('scrub').max")) + 1
    leave_controls(browser)
    for key, mode in (("1", "a"), ("2", "b"), ("d", "difference"), ("s", "slider")):
        checks.changes(lambda: browser.key(key), f"key {key}")
        checks.that(pressed(browser, f"[data-mode={mode}]"), f"key {key} presses its button")
    for mode in ("a", "b", "difference", "slider"):
        checks.changes(lambda: browser.click(f"[data-mode={mode}]"), f"button {mode}")
        checks.that(pressed(browser, f"[data-mode={mode}]"), f"button {mode} is pressed")
    # Gaze and rings, by key and button. What is undone must give the same picture.
    for key, name in (("g", "gaze"), ("r", "rings"), ("z", "zoom")):
        there = browser.run("return JSON.parse(document.getElementById('data').textContent).sets[0].frames.some((frame) => arguments[0] === 'rings' ? frame.rings.length > 0 : frame.gaze !== null)", name)
        checks.that(offers(browser, f"#toggle-{name}") == (there or name == "zoom"), f"button {name} is there where there is something to show")
        if not offers(browser, f"#toggle-{name}"):
            continue
        leave_controls(browser)
        checks.changes(lambda: browser.key(key), f"key {key}", lambda: browser.key(key))
        checks.changes(lambda: browser.click(f"#toggle-{name}"), f"button {name}", lambda: browser.click(f"#toggle-{name}"))
    # The slider, by its control and by dragging in the picture.
    checks.changes(lambda: browser.run("const s = document.getElementById('split'); s.value = 20; s.dispatchEvent(new Event('input'))"), "the split")
    checks.changes(lambda: browser.drag("#canvas", 0.8), "dragging")
    checks.that(abs(int(value(browser, "#split")) - 80) <= 2, "dragging to 80 % splits there")
    # Difference and its factor.
    leave_controls(browser)
    browser.key("d")
    for option in (0, 2):  # Chromium draws the first differences with marks of other bits than all that follow
        choose(browser, "#gain", option)
        checks.pixels()
    checks.changes(lambda: choose(browser, "#gain", 0), "the difference's factor", lambda: choose(browser, "#gain", 2))
    checks.that(browser.run("return document.getElementById('gain-label').offsetParent !== null"), "the factor is offered")
    # B against itself differs nowhere: black without marks.
    first = browser.run("return document.getElementById('view-a').selectedIndex")
    choose(browser, "#view-a", browser.run("return document.getElementById('view-b').selectedIndex"))
    browser.key("g"), browser.key("r")
    time.sleep(0.3)
    checks.that(browser.run(PIXELS + "for (let i = 0; i < d.length; ++i) if (i % 4 < 3 && d[i] !== 0) return false; return true"), "a run does not differ from itself")
    browser.key("g"), browser.key("r")
    choose(browser, "#view-a", first)
    # Blink: changes by itself.
    browser.key("b")
    checks.that(pressed(browser, "[data-mode=blink]"), "key b presses its button")
    seen = set()
    for _ in range(6):
        seen.add(checks.pixels())
    checks.that(len(seen) >= 2, "blinking changes the picture")
    browser.click("[data-mode=blink]")
    checks.that(pressed(browser, "[data-mode=blink]"), "button blink is pressed")
    browser.click("[data-mode=slider]")
    # The map of FLIP of B: there for runs of a sweep with FLIP, not for the reference.
    if offers(browser, "[data-mode=flip]"):
        leave_controls(browser)
        checks.changes(lambda: browser.key("f"), "key f", lambda: browser.key("s"))
        checks.changes(lambda: browser.click("[data-mode=flip]"), "button flip", lambda: browser.click("[data-mode=slider]"))
    # Which runs.
    for select in ("#view-a", "#view-b"):
        count = browser.run("return document.querySelector(arguments[0]).options.length", select)
        now = browser.run("return document.querySelector(arguments[0]).selectedIndex", select)
        if count > 2:
            checks.changes(lambda: choose(browser, select, count - 1 if now != count - 1 else 0), select, lambda: choose(browser, select, now))
    sets = browser.run("return document.getElementById('view-set').options.length")
    checks.that(sets > 0, "a scene is offered")
    if sets > 1:
        checks.changes(lambda: choose(browser, "#view-set", 1), "the scene")
        choose(browser, "#view-set", 0)
        frames = int(browser.run("return document.getElementById('scrub').max")) + 1
    # Frames.
    if frames > 1:
        leave_controls(browser)
        browser.run("const s = document.getElementById('scrub'); s.value = 0; s.dispatchEvent(new Event('input'))")
        checks.changes(lambda: browser.key("ArrowRight"), "the right arrow", lambda: browser.key("ArrowLeft"))
        checks.changes(lambda: browser.click("#next"), "button next", lambda: browser.click("#previous"))
        checks.changes(lambda: browser.run("const s = document.getElementById('scrub'); s.value = s.max; s.dispatchEvent(new Event('input'))"), "scrubbing")
        checks.that(int(value(browser, "#scrub")) == frames - 1, "scrubbing reaches the last frame")
        leave_controls(browser)
        browser.key("ArrowRight")
        checks.that(value(browser, "#scrub") == "0", "after the last frame comes the first")
        browser.key(" ")
        checks.that(pressed(browser, "#play"), "space plays")
        seen = set()
        for _ in range(20):
            seen.add(value(browser, "#scrub"))
            time.sleep(0.06)
        checks.that(len(seen) > 1, "playing goes through frames")
        browser.key(" ")
        checks.that(not pressed(browser, "#play"), "space stops")
        browser.click("#play")
        checks.that(pressed(browser, "#play"), "button play plays")
        browser.click("#play")
        checks.that(not pressed(browser, "#play"), "button play stops")
    status = browser.run("return document.getElementById('status').textContent")
    checks.that("Frame" in status and "A:" in status and "B:" in status, "the status says what is shown")
    label = browser.run("return document.getElementById('canvas').getAttribute('aria-label')")
    checks.that("A is" in label, "the canvas has words for those who do not see it")


def look_over(browser, checks, width):
    scroll = browser.run("return document.documentElement.scrollWidth")
    checks.that(scroll <= width, f"nothing sticks out to the side ({scroll} of {width} px)")
    nameless = browser.run(
        "return [...document.querySelectorAll('button, input, select, canvas')].filter((e) => !(e.getAttribute('aria-label') ||"
        "(e.labels && e.labels.length) || e.textContent.trim())).map((e) => e.id || e.outerHTML.slice(0, 60))")
    checks.that(not nameless, f"every control has a name: {nameless}")
    checks.that(browser.run("return document.querySelectorAll('#tables table').length") > 0, "there are tables")
    small = browser.run("return [...document.querySelectorAll('button, select')].filter((e) => e.offsetParent !== null &&"
                        "e.getBoundingClientRect().height < 24).length")
    checks.that(small == 0, "controls are at least 24 px high")


def run(arguments, name, width, height, mobile, dark):
    print(f"{name}{' dark' if dark else ''}: {width}x{height}")
    browser = Browser(arguments.driver, arguments.chromium, width, height, mobile, dark)
    checks = Checks(browser)
    try:
        address = arguments.report.resolve().as_uri()
        browser.call("POST", "/url", {"url": "about:blank"})
        browser.requests()  # of the page that a new window shows
        browser.call("POST", "/url", {"url": address})
        look_over(browser, checks, width)
        use_diagrams(browser, checks)
        if not browser.run("return document.getElementById('viewer-body').hidden"):
            use_viewer(browser, checks)
        browser.click("#copy")
        time.sleep(0.2)
        checks.that(browser.run("return document.getElementById('copied').textContent") != "", "copying says what it did")
        for link in browser.run("return [...document.querySelectorAll('nav a')].map((a) => a.getAttribute('href'))"):
            checks.that(browser.run("return document.querySelector(arguments[0]) !== null", link), f"{link} leads somewhere")
        if arguments.shots:
            arguments.shots.mkdir(parents=True, exist_ok=True)
            for section in ("short", "tables", "diagrams", "plot-time", "viewer", "canvas", "methods"):
                browser.run("const e = document.getElementById(arguments[0]); scrollTo({top: e.getBoundingClientRect().top + scrollY - 8, behavior: 'instant'})", section)
                time.sleep(0.2)
                browser.shot(arguments.shots / f"{name}{'_dark' if dark else ''}_{section}.png")
        console = browser.console()
        checks.that(not console, f"the console is empty: {console}")
        outside = [url for url in browser.requests() if not url.startswith(("data:", address))]
        checks.that(not outside, f"nothing was asked for: {outside}")
    finally:
        browser.close()
    print(f"  {checks.passed} checks passed, {len(checks.failed)} failed")
    return not checks.failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("report", type=Path)
    parser.add_argument("--shots", type=Path, help="folder for screenshots")
    parser.add_argument("--driver", default="chromedriver")
    parser.add_argument("--chromium", default=shutil.which("chromium") or "/usr/bin/chromium")
    arguments = parser.parse_args()
    good = True
    for name, (width, height, mobile) in SIZES.items():
        for dark in (False, True):
            good = run(arguments, name, width, height, mobile, dark) and good
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
