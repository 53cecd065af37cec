"use strict";
/* What the controls do. */

(() => {
  const { poses, meshes } = JSON.parse(document.getElementById("data").textContent);
  const get = (id) => document.getElementById(id);
  const canvas = get("canvas");
  const viewer = Viewer.create(canvas, [...document.querySelectorAll(".axis")]);
  const chart = Chart.create(get("chart"), get("readout"), chooseMode);
  let pose = 0, mode = 0, playing = !window.matchMedia("(prefers-reduced-motion: reduce)").matches, before = 0;

  if (!viewer) document.body.classList.add("no-webgl");

  function choosePose(k) {
    pose = k;
    document.querySelectorAll("[data-pose]").forEach((each) => { each.hidden = +each.dataset.pose !== k; });
    if (get("pose")) get("pose").value = k;
    mode = Math.min(mode, poses[k].frequencies.length - 1);
    if (viewer) { viewer.state.mode = mode; viewer.show({ ...poses[k].scene, ...meshes[poses[k].mesh] }); }
    const has = poses[k].frf !== null;
    get("response").hidden = !has;
    if (has) { chart.state.mode = mode; chart.show(poses[k]); }
    chooseMode(mode);
  }

  function chooseMode(k) {
    mode = k;
    document.querySelectorAll(`input[name=mode-${pose}]`).forEach((each) => { each.checked = +each.value === k; });
    get("which").textContent = `Mode ${k + 1}, ${poses[pose].frequencies[k].toFixed(1)} Hz: ${poses[pose].labels[k]}`;
    if (viewer) viewer.setMode(k);
    if (poses[pose].frf) chart.setMode(k);
    draw();
  }

  const nextMode = (step) => chooseMode((mode + step + poses[pose].frequencies.length) % poses[pose].frequencies.length);

  function play(on) {
    playing = on;
    get("play").textContent = on ? "Pause" : "Play";
    get("play").setAttribute("aria-pressed", on);
    if (on) requestAnimationFrame((now) => { before = now; step(now); });
  }

  function step(now) {
    if (!playing) return;
    viewer.state.phase = (viewer.state.phase + (now - before) / 1000 * 0.6) % 1;
    before = now;
    get("phase").value = Math.round(viewer.state.phase * 360);
    viewer.draw();
    requestAnimationFrame(step);
  }

  const draw = () => { if (viewer) viewer.draw(); };
  const change = (act) => (...given) => { act(...given); draw(); };

  function controls() {
    get("play").addEventListener("click", () => play(!playing));
    get("phase").addEventListener("input", (event) => { play(false); viewer.state.phase = event.target.value / 360; draw(); });
    get("amplitude").addEventListener("input", (event) => { viewer.state.amplitude = event.target.value / 1000; draw(); });
    get("ground").addEventListener("change", (event) => { viewer.state.ground = event.target.value; draw(); });
    get("colour").addEventListener("change", (event) => {
      viewer.state.byPart = event.target.value === "part";
      get("scale").hidden = viewer.state.byPart;
      draw();
    });
    document.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", change(() => viewer.look(button.dataset.view))));
    document.querySelectorAll("[data-zoom]").forEach((button) => button.addEventListener("click", change(() => viewer.zoom(+button.dataset.zoom))));
    canvas.addEventListener("keydown", keys);
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas && !event.ctrlKey) return;
      event.preventDefault();
      viewer.zoom(Math.exp(event.deltaY * 1e-3));
      draw();
    }, { passive: false });
    pointers();
    new ResizeObserver(draw).observe(canvas);
  }

  function keys(event) {
    const acts = {
      ArrowLeft: () => viewer.turn(-0.1, 0), ArrowRight: () => viewer.turn(0.1, 0),
      ArrowUp: () => viewer.turn(0, 0.1), ArrowDown: () => viewer.turn(0, -0.1),
      "+": () => viewer.zoom(0.85), "=": () => viewer.zoom(0.85), "-": () => viewer.zoom(1.18),
      " ": () => play(!playing), Home: () => viewer.look("iso"),
      n: () => nextMode(1), p: () => nextMode(-1),
    };
    const digit = +event.key - 1, known = digit >= 0 && digit < poses[pose].frequencies.length;
    if (event.ctrlKey || event.metaKey || event.altKey || (!acts[event.key] && !known)) return;
    event.preventDefault();
    if (known) chooseMode(digit); else acts[event.key]();
    draw();
  }

  function pointers() {
    const down = new Map();
    const spread = () => { const [a, b] = [...down.values()]; return b ? Math.hypot(a.x - b.x, a.y - b.y) : 0; };
    canvas.addEventListener("pointerdown", (event) => {
      down.set(event.pointerId, { x: event.clientX, y: event.clientY });
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const last = down.get(event.pointerId), wide = spread();
      if (!last) return;
      const [x, y] = [event.clientX - last.x, event.clientY - last.y];
      down.set(event.pointerId, { x: event.clientX, y: event.clientY });
      if (down.size === 2 && wide) viewer.zoom(wide / Math.max(spread(), 1));
      else if (event.shiftKey || event.buttons === 4) viewer.pan(x / canvas.clientHeight, y / canvas.clientHeight);
      else viewer.turn(x * 0.008, y * 0.008);
      draw();
    });
    for (const kind of ["pointerup", "pointercancel"]) canvas.addEventListener(kind, (event) => down.delete(event.pointerId));
  }

  document.querySelectorAll("input[type=radio][name^=mode-]").forEach((each) => each.addEventListener("change", () => chooseMode(+each.value)));
  if (get("pose")) get("pose").addEventListener("change", (event) => choosePose(+event.target.value));
  get("quantity").addEventListener("change", (event) => { chart.state.quantity = event.target.value; chart.compute(); });
  document.querySelectorAll("[data-curve]").forEach((box) => box.addEventListener("change", () => {
    chart.state.shown[box.checked ? "add" : "delete"](box.dataset.curve);
    chart.draw();
  }));
  document.querySelectorAll("[data-chart]").forEach((button) => button.addEventListener("click", () => (button.dataset.chart === "reset" ? chart.reset() : chart.zoom(+button.dataset.chart))));
  window.addEventListener("beforeprint", () => document.querySelectorAll("details, [data-pose]").forEach((each) => {
    each.dataset.was = each.tagName === "DETAILS" ? each.open : each.hidden;
    if (each.tagName === "DETAILS") each.open = true; else each.hidden = false;
  }));
  window.addEventListener("afterprint", () => document.querySelectorAll("[data-was]").forEach((each) => {
    each[each.tagName === "DETAILS" ? "open" : "hidden"] = each.dataset.was === "true";
  }));

  if (viewer) controls();
  choosePose(0);
  if (viewer) play(playing);
})();
