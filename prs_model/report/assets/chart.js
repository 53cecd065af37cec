"use strict";
/* Frequency responses as SVG that is drawn anew at every size: cursor, zoom, choice of curves and of quantity. */

const Chart = (() => {
  const SPACE = "http://www.w3.org/2000/svg";
  const AXES = ["u", "v", "w"];
  const QUANTITIES = {
    receptance: { order: 0, scale: 1e6, unit: "µm/N" },
    mobility: { order: 1, scale: 1e3, unit: "mm/s/N" },
    accelerance: { order: 2, scale: 1, unit: "m/s²/N" },
  };
  const EDGE = { left: 64, right: 12, top: 30, bottom: 40, between: 12 };
  const node = (name, attributes, text) => {
    const made = document.createElementNS(SPACE, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    return made;
  };
  const short = (x) => (x === 0 ? "0" : Math.abs(x) >= 1e-3 && Math.abs(x) < 1e5 ? +x.toPrecision(4) + "" : x.toExponential(2));
  const raised = (n) => `10${[...String(n)].map((d) => ({ "-": "⁻" })[d] || "⁰¹²³⁴⁵⁶⁷⁸⁹"[d]).join("")}`;

  function steps(low, high, most) {
    const rough = (high - low) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough);
    const all = [];
    for (let x = Math.ceil(low / step) * step; x <= high + 1e-9 * step; x += step) all.push(+x.toPrecision(10));
    return all;
  }

  /* host: an element with a size; readout: where the cursor's numbers are told; choose(k): a mode was asked for. */
  function create(host, readout, choose) {
    const state = { quantity: "receptance", shown: new Set(AXES), range: [0, 1], cursor: 0, mode: 0 };
    let data = null, curves = {}, geometry = null, from = null;

    function show(pose) {
      data = pose;
      state.range = [0, pose.frf.hz.length - 1];
      state.cursor = nearest(pose.frequencies[state.mode] || 0);
      compute();
    }

    function compute() {
      const { order, scale } = QUANTITIES[state.quantity];
      curves = Object.fromEntries(AXES.map((axis) => {
        const [real, imag] = data.frf.curves[axis];
        const size = real.map((x, k) => scale * Math.hypot(x, imag[k]) * (2 * Math.PI * data.frf.hz[k]) ** order);
        const turn = real.map((x, k) => {
          const degrees = (Math.atan2(imag[k], x) * 180) / Math.PI + 90 * order;
          return degrees > 180.5 ? degrees - 360 : degrees;
        });
        return [axis, { size, turn }];
      }));
      draw();
    }

    const nearest = (hz) => data.frf.hz.reduce((best, x, k) => (Math.abs(x - hz) < Math.abs(data.frf.hz[best] - hz) ? k : best), 0);

    function draw() {
      const width = host.clientWidth || 640, height = width < 560 ? 380 : 440;
      const [a, b] = state.range, hz = data.frf.hz;
      const shown = AXES.filter((axis) => state.shown.has(axis));
      const seen = shown.flatMap((axis) => curves[axis].size.slice(a, b + 1)).filter((x) => x > 0);
      const low = Math.floor(Math.log10(Math.min(...seen, 1e300)) * 2) / 2, high = Math.ceil(Math.log10(Math.max(...seen, 1e-300)) * 4) / 4;
      const [bottom, top] = seen.length ? [low, Math.max(high, low + 0.5)] : [-3, 0];
      const split = EDGE.top + 0.66 * (height - EDGE.top - EDGE.bottom - EDGE.between);
      const x = (f) => EDGE.left + ((f - hz[a]) / (hz[b] - hz[a])) * (width - EDGE.left - EDGE.right);
      const y = (v) => split - ((Math.log10(Math.max(v, 1e-300)) - bottom) / (top - bottom)) * (split - EDGE.top);
      const z = (v) => height - EDGE.bottom - ((v + 190) / 380) * (height - EDGE.bottom - split - EDGE.between);
      geometry = { width, height, split, x, y, z };
      const svg = node("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": spoken(shown) });
      grid(svg, bottom, top);
      marks(svg);
      svg.append(clip());
      for (const axis of shown) {
        for (const [part, f] of [["size", y], ["turn", z]]) {
          const path = hz.slice(a, b + 1).map((value, k) => `${k ? "L" : "M"}${x(value).toFixed(1)} ${f(curves[axis][part][a + k]).toFixed(1)}`);
          svg.append(node("path", { d: path.join(""), class: `curve ${axis}`, "clip-path": "url(#inside)" }));
        }
      }
      svg.append(node("g", { class: "cursor" }), node("rect", { class: "chosen", y: EDGE.top, height: height - EDGE.top - EDGE.bottom, width: 0 }));
      host.replaceChildren(svg);
      cursor();
    }

    const clip = () => {
      const path = node("clipPath", { id: "inside" });
      path.append(node("rect", { x: EDGE.left, y: EDGE.top, width: geometry.width - EDGE.left - EDGE.right, height: geometry.height - EDGE.top - EDGE.bottom }));
      return path;
    };

    function grid(svg, bottom, top) {
      const { width, height, split, x, y, z } = geometry, [a, b] = state.range, hz = data.frf.hz;
      const line = (x1, y1, x2, y2, kind) => svg.append(node("line", { x1, y1, x2, y2, class: kind }));
      const text = (at, word, anchor, kind = "tick") => svg.append(node("text", { x: at[0], y: at[1], "text-anchor": anchor, class: kind }, word));
      for (const f of steps(hz[a], hz[b], width < 560 ? 5 : 9)) {
        line(x(f), EDGE.top, x(f), height - EDGE.bottom, "grid");
        text([x(f), height - EDGE.bottom + 16], short(f), "middle");
      }
      for (let n = Math.ceil(bottom); n <= top; n++) {
        line(EDGE.left, y(10 ** n), width - EDGE.right, y(10 ** n), "grid");
        text([EDGE.left - 6, y(10 ** n) + 4], raised(n), "end");
      }
      if (top - bottom < 2.2) for (let n = Math.floor(bottom); n <= top; n++) for (const m of [2, 5]) {
        const v = m * 10 ** n;
        if (Math.log10(v) < bottom || Math.log10(v) > top) continue;
        line(EDGE.left, y(v), width - EDGE.right, y(v), "grid");
        text([EDGE.left - 6, y(v) + 4], short(v), "end");
      }
      for (const v of [-180, -90, 0, 90, 180]) {
        line(EDGE.left, z(v), width - EDGE.right, z(v), "grid");
        text([EDGE.left - 6, z(v) + 4], v, "end");
      }
      line(EDGE.left, split + EDGE.between / 2, width - EDGE.right, split + EDGE.between / 2, "frame");
      text([(EDGE.left + width - EDGE.right) / 2, height - 6], "frequency / Hz", "middle", "label");
      for (const [middle, word] of [[(EDGE.top + split) / 2, `${state.quantity} / (${QUANTITIES[state.quantity].unit})`], [(split + height - EDGE.bottom + EDGE.between) / 2, "phase / °"]]) {
        svg.append(node("text", { transform: `translate(13 ${middle}) rotate(-90)`, "text-anchor": "middle", class: "label" }, word));
      }
    }

    /* Natural frequencies, numbered above. */
    function marks(svg) {
      const [a, b] = state.range, hz = data.frf.hz;
      let last = -99;
      data.frequencies.forEach((f, k) => {
        if (f < hz[a] || f > hz[b]) return;
        const x = geometry.x(f), group = node("g", { class: k === state.mode ? "mode here" : "mode" });
        group.append(node("line", { x1: x, x2: x, y1: EDGE.top - 6, y2: geometry.height - EDGE.bottom }));
        const place = x - last < 13 ? last + 13 : x;
        group.append(node("text", { x: place, y: EDGE.top - 11, "text-anchor": "middle" }, k + 1));
        group.append(node("title", {}, `mode ${k + 1}, ${f} Hz: ${data.labels[k]}`));
        group.addEventListener("click", () => choose(k));
        last = place;
        svg.append(group);
      });
    }

    function cursor() {
      const group = host.querySelector(".cursor"), k = state.cursor, x = geometry.x(data.frf.hz[k]);
      const shown = AXES.filter((axis) => state.shown.has(axis));
      const inside = k >= state.range[0] && k <= state.range[1];
      group.replaceChildren(...(inside ? [
        node("line", { x1: x, x2: x, y1: EDGE.top, y2: geometry.height - EDGE.bottom }),
        ...shown.map((axis) => node("circle", { cx: x, cy: geometry.y(curves[axis].size[k]), r: 3.5, class: axis })),
      ] : []));
      const { unit } = QUANTITIES[state.quantity];
      const told = shown.map((axis) => `${axis} ${short(curves[axis].size[k])} ${unit}, ${Math.round(curves[axis].turn[k])}°`.replaceAll(" ", "\u00a0"));
      readout.textContent = `${data.frf.hz[k].toFixed(1)} Hz:  ${told.join("   ")}`;
    }

    const spoken = (shown) => `${state.quantity} of the end-reference point along ${shown.join(", ")} from ${short(data.frf.hz[state.range[0]])} to ${short(data.frf.hz[state.range[1]])} Hz; arrow keys move the cursor`;

    const index = (event) => {
      const box = host.firstElementChild.getBoundingClientRect(), [a, b] = state.range, hz = data.frf.hz;
      const share = (event.clientX - box.left - EDGE.left) / (box.width - EDGE.left - EDGE.right);
      return nearest(hz[a] + Math.max(0, Math.min(1, share)) * (hz[b] - hz[a]));
    };

    function zoom(factor) {
      const [a, b] = state.range, last = data.frf.hz.length - 1, half = Math.max(10, Math.round(((b - a) * factor) / 2));
      const middle = Math.max(a, Math.min(b, state.cursor));
      state.range = [Math.max(0, middle - half), Math.min(last, middle + half)];
      draw();
    }

    const reset = () => { state.range = [0, data.frf.hz.length - 1]; draw(); };

    function move(step) {
      state.cursor = Math.max(0, Math.min(data.frf.hz.length - 1, state.cursor + step));
      const [a, b] = state.range, over = Math.max(0, state.cursor - b) - Math.max(0, a - state.cursor);
      if (over) { state.range = [a + over, b + over]; draw(); } else cursor();
    }

    host.addEventListener("keydown", (event) => {
      const fast = event.shiftKey ? 20 : 2;
      const acts = { ArrowLeft: () => move(-fast), ArrowRight: () => move(fast), "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), Home: reset, Enter: () => choose(closest()) };
      if (acts[event.key]) { acts[event.key](); event.preventDefault(); }
    });
    const closest = () => data.frequencies.reduce((best, f, k) => (Math.abs(f - data.frf.hz[state.cursor]) < Math.abs(data.frequencies[best] - data.frf.hz[state.cursor]) ? k : best), 0);
    host.addEventListener("pointerdown", (event) => { from = { x: event.clientX, k: index(event) }; });
    host.addEventListener("pointermove", (event) => {
      state.cursor = index(event);
      cursor();
      const box = host.querySelector(".chosen"), ends = from ? [geometry.x(data.frf.hz[from.k]), geometry.x(data.frf.hz[state.cursor])].sort((p, q) => p - q) : [0, 0];
      box.setAttribute("x", ends[0]);
      box.setAttribute("width", ends[1] - ends[0]);
    });
    window.addEventListener("pointerup", (event) => {
      if (!from) return;
      const [a, b] = [from.k, index(event)].sort((p, q) => p - q), wide = Math.abs(event.clientX - from.x) > 8;
      from = null;
      if (wide && b - a >= 4) { state.range = [a, b]; draw(); } else host.querySelector(".chosen").setAttribute("width", 0);
    });
    host.addEventListener("pointercancel", () => { from = null; });
    host.addEventListener("dblclick", reset);
    new ResizeObserver(() => { if (data && geometry && host.clientWidth !== geometry.width) draw(); }).observe(host);

    return { state, show, compute, draw, zoom, reset, setMode: (k) => { state.mode = k; if (data) { state.cursor = nearest(data.frequencies[k]); draw(); } } };
  }

  return { create };
})();
