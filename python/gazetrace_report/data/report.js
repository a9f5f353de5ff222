// SPDX-License-Identifier: Apache-2.0
// Diagrams to choose from and the frame viewer. Everything it shows is in the page.
"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const by = (id) => document.getElementById(id);

  const fillSelect = (select, entries, chosen) => {
    select.replaceChildren(...entries.map(([value, words]) => {
      const option = document.createElement("option");
      option.value = value;
      option.textContent = words;
      return option;
    }));
    if (entries.some(([value]) => value === chosen)) select.value = chosen;
  };
  const shown = (value) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(4))));

  // Diagrams -----------------------------------------------------------------------------------------------------
  const plotSet = by("plot-set"), plotRow = by("plot-row"), plotMetric = by("plot-metric");
  const drawPlots = () => {
    const missing = [];
    for (const [kind, words] of [["pareto", "error against time"], ["time", "error over time"], ["bands", "error by eccentricity"]]) {
      const plot = data.plots.find((one) => one.kind === kind && one.set === plotSet.value &&
        one.metric === plotMetric.value && (one.row === "" || one.row === plotRow.value));
      by("plot-" + kind).innerHTML = plot ? plot.svg : "";
      if (!plot && data.plots.some((one) => one.kind === kind)) missing.push(words);
    }
    by("plot-none").hidden = missing.length === 0;
    by("plot-none").textContent = `Without scores for this choice: ${missing.join(", ")}.`;
  };
  const choosePlotSet = () => {
    fillSelect(plotRow, data.tests.filter((row) => row.set === plotSet.value).map((row) => [row.id, row.label]), plotRow.value);
    drawPlots();
  };
  fillSelect(plotSet, data.sets.map((set) => [set.id, set.name]));
  fillSelect(plotMetric, data.metrics.map((name) => [name, name]), data.metrics.includes("flip") ? "flip" : undefined);
  plotSet.addEventListener("change", choosePlotSet);
  plotRow.addEventListener("change", drawPlots);
  plotMetric.addEventListener("change", drawPlots);
  choosePlotSet();

  // Methods ------------------------------------------------------------------------------------------------------
  by("copy").addEventListener("click", async () => {
    const text = by("methods-text").textContent;
    let done = false;
    try {
      await navigator.clipboard.writeText(text);
      done = true;
    } catch {
      const range = document.createRange();
      range.selectNodeContents(by("methods-text"));
      getSelection().removeAllRanges();
      getSelection().addRange(range);
    }
    by("copied").textContent = done ? "Copied." : "Selected: copy it with the keyboard.";
  });

  // Frames -------------------------------------------------------------------------------------------------------
  const sets = data.sets.filter((set) => set.runs.length > 0);
  if (sets.length === 0) {
    by("viewer-body").hidden = true;
    by("viewer-none").hidden = false;
    return;
  }
  const canvas = by("canvas"), context = canvas.getContext("2d");
  const viewSet = by("view-set"), viewA = by("view-a"), viewB = by("view-b");
  const scrub = by("scrub"), split = by("split"), gain = by("gain");
  const kBlinkMs = 500;   // two changes a second: below what harms people who are sensitive to flashes
  const kZoom = 4;
  const state = { mode: "slider", gaze: true, rings: true, zoom: false, playing: false, phase: 0, set: null, a: null, b: null };

  // Decoded pictures, the latest ones: a long clip would fill the memory.
  const kKept = 64;
  const decoded = new Map();
  const picture = (index) => {
    if (index === null || index === undefined) return Promise.resolve(null);
    let promise = decoded.get(index);
    if (!promise) {
      const image = new Image();
      image.src = data.pictures[index];
      promise = image.decode().then(() => image, () => null);
    }
    decoded.delete(index);
    decoded.set(index, promise);
    if (decoded.size > kKept) decoded.delete(decoded.keys().next().value);
    return promise;
  };

  // The part of the frame that is seen, in fractions of it.
  const windowOf = (frame) => {
    if (!state.zoom) return { x: 0, y: 0, size: 1 };
    const [u, v] = frame.gaze || [0.5, 0.5];
    const inside = (middle) => Math.min(Math.max(middle - 0.5 / kZoom, 0), 1 - 1 / kZoom);
    return { x: inside(u), y: inside(v), size: 1 / kZoom };
  };
  // As many pixels as the screen has there: rings, dot and slider are drawn sharp, whatever the size of the pictures.
  const fitCanvas = (image) => {
    const aspect = image.width / image.height;
    canvas.style.aspectRatio = String(aspect);
    canvas.style.width = `min(100%, ${(86 * aspect).toFixed(2)}vh)`;
    const box = canvas.getBoundingClientRect();
    const ratio = window.devicePixelRatio || 1;
    const w = Math.max(1, Math.round(box.width * ratio)), h = Math.max(1, Math.round(box.width * ratio / aspect));
    if (canvas.width !== w || canvas.height !== h) {
      canvas.width = w;
      canvas.height = h;
    }
  };
  const drawPicture = (image, view, from, to, missing = "no picture of this frame") => {
    const w = canvas.width, h = canvas.height;
    context.save();
    context.beginPath();
    context.rect(from * w, 0, (to - from) * w, h);
    context.clip();
    if (image) {
      // Pixels of the picture stay squares where each covers several of the screen.
      context.imageSmoothingEnabled = view.size * image.width > w / 2;
      context.imageSmoothingQuality = "high";
      context.drawImage(image, view.x * image.width, view.y * image.height, view.size * image.width, view.size * image.height, 0, 0, w, h);
    } else {
      context.fillStyle = "#333";
      context.fillRect(0, 0, w, h);
      context.fillStyle = "#fff";
      context.font = `${Math.max(12, w / 40)}px sans-serif`;
      context.textAlign = "center";
      context.fillText(missing, (from + to) / 2 * w, h / 2);
    }
    context.restore();
  };
  // In the pictures' own pixels, and scaled afterwards: browsers do not scale to the same bits for every way of drawing.
  const drawDifference = (a, b, view) => {
    if (!a || !b) return drawPicture(a, view, 0, 1);
    const own = document.createElement("canvas");
    own.width = a.width;
    own.height = a.height;
    const pen = own.getContext("2d");
    pen.drawImage(a, 0, 0);
    pen.globalCompositeOperation = "difference";
    pen.drawImage(b, 0, 0, own.width, own.height);
    pen.globalCompositeOperation = "lighter";
    for (let factor = Number(gain.value); factor > 1; factor /= 2) pen.drawImage(own, 0, 0);
    drawPicture(own, view, 0, 1);
  };
  const drawOverlay = (frame, view) => {
    if (!frame.gaze) return;
    const w = canvas.width, h = canvas.height, unit = Math.max(1, window.devicePixelRatio || 1);
    const x = (frame.gaze[0] - view.x) / view.size * w, y = (frame.gaze[1] - view.y) / view.size * h;
    const ringed = (radius) => {
      for (const [color, width] of [["#000", 3.5], ["#fff", 1.5]]) {
        context.beginPath();
        context.arc(x, y, radius, 0, 2 * Math.PI);
        context.lineWidth = width * unit;
        context.strokeStyle = color;
        context.stroke();
      }
    };
    if (state.rings) for (const radius of frame.rings) ringed(radius / view.size * w);
    if (state.gaze) {
      context.beginPath();
      context.arc(x, y, 3.5 * unit, 0, 2 * Math.PI);
      context.fillStyle = "#ffd23f";
      context.fill();
      ringed(6 * unit);
    }
  };
  const runWords = (name, run, at) => {
    const scores = Object.entries(run.scores[at] || {}).map(([metric, value]) => `${metric} ${shown(value)}`);
    const time = run.times[at];
    return `${name}: ${run.label}` + (time === null ? "" : `, ${shown(time)} s`) + (scores.length ? `, ${scores.join(", ")}` : "");
  };
  const kModeWords = { slider: "A left, B right", a: "A", b: "B", difference: "difference", blink: "A and B in turns", flip: "map of FLIP of B" };

  let drawn = 0;
  const draw = async () => {
    const turn = ++drawn;
    const at = Number(scrub.value), frame = state.set.frames[at];
    const [a, b, map] = await Promise.all([picture(state.a.pictures[at]), picture(state.b.pictures[at]),
      state.mode === "flip" ? picture(state.b.maps[at]) : null]);
    if (turn !== drawn) return;
    const first = a || b;
    if (first) fitCanvas(first);
    const view = windowOf(frame);
    const half = Number(split.value) / 100;
    if (state.mode === "slider") {
      drawPicture(a, view, 0, half);
      drawPicture(b, view, half, 1);
      context.fillStyle = "#fff";
      const line = 2 * Math.max(1, window.devicePixelRatio || 1);
      context.fillRect(half * canvas.width - line / 2, 0, line, canvas.height);
    } else if (state.mode === "difference") {
      drawDifference(a, b, view);
    } else if (state.mode === "flip") {
      drawPicture(map, view, 0, 1, "no map of FLIP for B");
    } else {
      const showB = state.mode === "b" || (state.mode === "blink" && state.phase === 1);
      drawPicture(showB ? b : a, view, 0, 1);
    }
    drawOverlay(frame, view);
    const what = `Frame ${frame.index}, ${shown(frame.t_s)} s` + (frame.event === "none" ? "" : `, ${frame.event}`);
    if (!state.playing) {
      by("status").textContent = `${what}. ${runWords("A", state.a, at)}. ${runWords("B", state.b, at)}.`;
    }
    canvas.setAttribute("aria-label", `${what}, ${kModeWords[state.mode]}. A is ${state.a.label}, B is ${state.b.label}.`);
    canvas.dataset.drawn = String(turn);
    // The next frame is decoded meanwhile.
    const next = (at + 1) % state.set.frames.length;
    picture(state.a.pictures[next]);
    picture(state.b.pictures[next]);
  };

  const press = (button, on) => button.setAttribute("aria-pressed", String(on));
  const setMode = (mode) => {
    state.mode = mode;
    document.querySelectorAll("[data-mode]").forEach((button) => press(button, button.dataset.mode === mode));
    by("split-label").hidden = mode !== "slider";
    by("gain-label").hidden = mode !== "difference";
    canvas.style.cursor = mode === "slider" ? "ew-resize" : "default";
    draw();
  };
  const toggle = (name) => {
    state[name] = !state[name];
    press(by("toggle-" + name), state[name]);
    draw();
  };
  const step = (by_frames) => {
    const count = state.set.frames.length;
    scrub.value = String((Number(scrub.value) + by_frames + count) % count);
    draw();
  };
  let timer = 0;
  const frameMs = () => {
    const frames = state.set.frames;
    const seconds = frames.length > 1 ? (frames[frames.length - 1].t_s - frames[0].t_s) / (frames.length - 1) : 0;
    return Math.min(1000, Math.max(20, seconds > 0 ? seconds * 1000 : 100));
  };
  const play = (on) => {
    state.playing = on && state.set.frames.length > 1;
    press(by("play"), state.playing);
    clearTimeout(timer);
    if (!state.playing) {
      draw();
      return;
    }
    const tick = async () => {
      const started = performance.now();
      scrub.value = String((Number(scrub.value) + 1) % state.set.frames.length);
      await draw();
      if (state.playing) timer = setTimeout(tick, Math.max(0, frameMs() - (performance.now() - started)));
    };
    timer = setTimeout(tick, frameMs());
  };
  setInterval(() => {
    if (state.mode !== "blink" || document.hidden) return;
    state.phase = 1 - state.phase;
    draw();
  }, kBlinkMs);

  const has = {};
  const runOf = (select) => state.set.runs[Number(select.value)];
  const chooseSet = () => {
    state.set = sets.find((set) => set.id === viewSet.value);
    const entries = state.set.runs.map((run, index) => [String(index), run.label]);
    fillSelect(viewA, entries, "0");
    fillSelect(viewB, entries, entries.length > 1 ? "1" : "0");
    scrub.max = String(state.set.frames.length - 1);
    scrub.value = "0";
    // Nothing is offered that this set does not have.
    has.gaze = state.set.frames.some((frame) => frame.gaze !== null);
    has.rings = state.set.frames.some((frame) => frame.rings.length > 0);
    has.maps = state.set.runs.some((run) => run.maps.some((map) => map !== null));
    document.querySelectorAll("[data-needs]").forEach((one) => { one.hidden = !has[one.dataset.needs]; });
    chooseRuns();
    if (state.mode === "flip" && !has.maps) setMode("slider");
  };
  const chooseRuns = () => {
    state.a = runOf(viewA);
    state.b = runOf(viewB);
    draw();
  };

  fillSelect(viewSet, sets.map((set) => [set.id, set.name]));
  viewSet.addEventListener("change", chooseSet);
  viewA.addEventListener("change", chooseRuns);
  viewB.addEventListener("change", chooseRuns);
  scrub.addEventListener("input", draw);
  split.addEventListener("input", draw);
  gain.addEventListener("change", draw);
  document.querySelectorAll("[data-mode]").forEach((button) => button.addEventListener("click", () => setMode(button.dataset.mode)));
  for (const name of ["gaze", "rings", "zoom"]) by("toggle-" + name).addEventListener("click", () => toggle(name));
  by("previous").addEventListener("click", () => step(-1));
  by("next").addEventListener("click", () => step(1));
  by("play").addEventListener("click", () => play(!state.playing));

  const dragTo = (event) => {
    if (state.mode !== "slider" || event.buttons === 0) return;
    const box = canvas.getBoundingClientRect();
    split.value = String(Math.round(100 * Math.min(1, Math.max(0, (event.clientX - box.left) / box.width))));
    draw();
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    dragTo(event);
  });
  canvas.addEventListener("pointermove", dragTo);

  const kKeys = {
    s: () => setMode("slider"), 1: () => setMode("a"), 2: () => setMode("b"), d: () => setMode("difference"), b: () => setMode("blink"),
    f: () => has.maps && setMode("flip"),
    g: () => has.gaze && toggle("gaze"), r: () => has.rings && toggle("rings"), z: () => toggle("zoom"),
    ArrowLeft: () => step(-1), ArrowRight: () => step(1), " ": () => play(!state.playing),
  };
  const isViewerVisible = () => {
    const box = canvas.getBoundingClientRect();
    return box.bottom > 0 && box.top < innerHeight;
  };
  // Lists are searched by letters, sliders moved by arrows, buttons pressed by space, diagrams scrolled: those keep their keys.
  const keepsKey = (target, key) => target.closest("select, textarea") ||
    (key.startsWith("Arrow") && target.closest("input, figure, .scroll")) || (key === " " && target.closest("button"));
  document.addEventListener("keydown", (event) => {
    const action = kKeys[event.key];
    if (!action || event.ctrlKey || event.altKey || event.metaKey || keepsKey(event.target, event.key)) return;
    const scrolls = event.key === " " || event.key.startsWith("Arrow");
    if (scrolls && !isViewerVisible()) return;
    event.preventDefault();
    action();
  });

  window.addEventListener("resize", draw);
  chooseSet();
  setMode("slider");
})();
