"use strict";
/* The machine in WebGL 2: vertices are moved by the shader, rest + swing * moved, so that a frame costs one uniform. */

const Viewer = (() => {
  const VERTEX = `#version 300 es
    in vec3 rest; in vec3 moved; in float kind;
    uniform mat4 camera; uniform vec3 eye; uniform float swing;
    out vec3 place; out vec3 shift; flat out int part;
    void main() {
      place = rest + swing * moved;
      shift = moved;
      part = int(kind + 0.5);
      gl_Position = camera * vec4(place, 1.0);
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 place; in vec3 shift; flat in int part;
    uniform vec3 eye; uniform vec4 line; uniform float opacity; uniform bool byPart;
    uniform vec3 scale[6]; uniform vec3 parts[8];
    out vec4 colour;
    vec3 ofSize(float x) {
      float t = clamp(x, 0.0, 1.0) * 5.0;
      int k = int(min(floor(t), 4.0));
      return mix(scale[k], scale[k + 1], t - float(k));
    }
    void main() {
      if (line.a > 0.0) { colour = line; return; }
      vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
      vec3 toEye = normalize(eye - place);
      float facing = abs(dot(normal, toEye));
      float above = 0.5 + 0.5 * normal.z * sign(dot(normal, toEye));
      vec3 base = byPart ? parts[part % 8] : ofSize(length(shift));
      colour = vec4(base * (0.42 + 0.43 * facing + 0.15 * above), opacity);
    }`;
  const SCALE = [[0.27, 0.0, 0.33], [0.25, 0.27, 0.53], [0.16, 0.47, 0.56], [0.13, 0.66, 0.52], [0.48, 0.82, 0.32],
    [0.99, 0.91, 0.14]];
  const PARTS = [[0.35, 0.55, 0.75], [0.93, 0.69, 0.32], [0.45, 0.68, 0.45], [0.72, 0.46, 0.62], [0.85, 0.83, 0.5],
    [0.5, 0.5, 0.62], [0.82, 0.5, 0.42], [0.7, 0.78, 0.82]];
  const VIEWS = { iso: [-0.61, 0.36], front: [-Math.PI / 2, 0], side: [0, 0], top: [-Math.PI / 2, Math.PI / 2 - 1e-3] };

  const typed = (text, Type) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Type(bytes.buffer);
  };

  function program(gl) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    return made;
  }

  const minus = (a, b) => a.map((x, i) => x - b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => a.map((x) => x / Math.hypot(...a));

  /* Column-major projection * view, and the eye, of a camera that looks at `target` with z up. */
  function camera(view, aspect) {
    const toward = [Math.cos(view.pitch) * Math.cos(view.yaw), Math.cos(view.pitch) * Math.sin(view.yaw),
      Math.sin(view.pitch)];
    const right = [-Math.sin(view.yaw), Math.cos(view.yaw), 0];
    const up = cross(toward, right);
    const eye = view.target.map((x, i) => x + view.distance * toward[i]);
    const near = view.distance / 50, far = view.distance * 20, lens = 1 / Math.tan(0.22) / Math.max(1, 1 / aspect);
    const rows = [
      [...right.map((x) => (x * lens) / aspect), (-dot(right, eye) * lens) / aspect],
      [...up.map((x) => x * lens), -dot(up, eye) * lens],
      [...toward.map((x) => (-x * (far + near)) / (far - near)),
        (dot(toward, eye) * (far + near) - 2 * far * near) / (far - near)],
      [...toward.map((x) => -x), dot(toward, eye)],
    ];
    return { matrix: [0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column])), eye, right, up };
  }

  /* canvas, labels: three elements that are put at the ends of u, v, w. Null where there is no WebGL 2. */
  function create(canvas, labels) {
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true, alpha: true });
    if (!gl) return null;
    const shader = program(gl);
    const at = Object.fromEntries(["camera", "eye", "swing", "line", "opacity", "byPart", "scale", "parts"]
      .map((name) => [name, gl.getUniformLocation(shader, name)]));
    const buffers = Object.fromEntries(["rest", "moved", "kind", "triangles", "edges", "axes"]
      .map((name) => [name, gl.createBuffer()]));
    const state = { mode: 0, amplitude: 0.06, phase: 0.25, ground: "clear", byPart: false, view: null };
    let scene = null;

    const fill = (target, buffer, data) => { gl.bindBuffer(target, buffer); gl.bufferData(target, data, gl.STATIC_DRAW); };
    const point = (name, buffer, size, type, normal) => {
      const place = gl.getAttribLocation(shader, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, type, normal, 0, 0);
    };

    function show(raw) {
      const first = scene === null;
      const steps = typed(raw.points, Uint16Array);
      const points = Float32Array.from(steps, (x, i) => raw.low[i % 3] + raw.step * x);
      scene = { ...raw, points, all: typed(raw.moved, raw.movedBytes === 1 ? Int8Array : Int16Array) };
      fill(gl.ARRAY_BUFFER, buffers.rest, scene.points);
      fill(gl.ARRAY_BUFFER, buffers.kind, typed(raw.kind, Uint8Array));
      const triangles = typed(raw.triangles, Uint32Array), edges = typed(raw.edges, Uint32Array);
      fill(gl.ELEMENT_ARRAY_BUFFER, buffers.triangles, triangles);
      fill(gl.ELEMENT_ARRAY_BUFFER, buffers.edges, edges);
      scene.triangleCount = triangles.length;
      scene.edgeCount = edges.length;
      const tips = raw.axes.flatMap((axis) => [...raw.output, ...raw.output.map((x, i) => x + 0.1 * raw.size * axis[i])]);
      fill(gl.ARRAY_BUFFER, buffers.axes, new Float32Array(tips));
      if (first) look("iso"); else state.view.target = [...raw.centre];
      setMode(state.mode);
    }

    function setMode(mode) {
      state.mode = mode;
      fill(gl.ARRAY_BUFFER, buffers.moved, scene.all.subarray(mode * scene.points.length, (mode + 1) * scene.points.length));
    }

    function look(name) {
      const [yaw, pitch] = VIEWS[name];
      state.view = { yaw, pitch, distance: 2.35 * scene.size, target: [...scene.centre] };
    }

    function turn(right, up) {
      state.view.yaw -= right;
      state.view.pitch = Math.max(-1.57, Math.min(1.57, state.view.pitch + up));
    }

    const zoom = (factor) => {
      state.view.distance = Math.max(0.2 * scene.size, Math.min(12 * scene.size, state.view.distance * factor));
    };

    function draw() {
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
      const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
      if (!width || !height) return;
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      const seen = camera(state.view, width / height);
      gl.viewport(0, 0, width, height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.enable(gl.BLEND);
      gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      gl.useProgram(shader);
      gl.uniformMatrix4fv(at.camera, false, seen.matrix);
      gl.uniform3fv(at.eye, seen.eye);
      gl.uniform1f(at.swing, state.amplitude * scene.size * Math.sin(2 * Math.PI * state.phase));
      gl.uniform3fv(at.scale, SCALE.flat());
      gl.uniform3fv(at.parts, PARTS.flat());
      gl.uniform1i(at.byPart, state.byPart ? 1 : 0);
      point("rest", buffers.rest, 3, gl.FLOAT, false);
      point("moved", buffers.moved, 3, scene.movedBytes === 1 ? gl.BYTE : gl.SHORT, true);
      point("kind", buffers.kind, 1, gl.UNSIGNED_BYTE, false);
      faces(0, scene.freeTriangles, 1);
      lines(0, scene.freeEdges, 0.55);
      if (state.ground !== "hidden") {
        const clear = state.ground === "clear";
        gl.depthMask(!clear);
        lines(scene.freeEdges, scene.edgeCount, clear ? 0.22 : 0.55);
        faces(scene.freeTriangles, scene.triangleCount, clear ? 0.1 : 1);
        gl.depthMask(true);
      }
      axes();
      place(seen, width / height);
    }

    function faces(from, to, opacity) {
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
      gl.uniform4f(at.line, 0, 0, 0, 0);
      gl.uniform1f(at.opacity, opacity);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.triangles);
      gl.drawElements(gl.TRIANGLES, to - from, gl.UNSIGNED_INT, 4 * from);
      gl.disable(gl.POLYGON_OFFSET_FILL);
    }

    function lines(from, to, opacity) {
      gl.uniform4f(at.line, 0.08, 0.1, 0.14, opacity);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, buffers.edges);
      gl.drawElements(gl.LINES, to - from, gl.UNSIGNED_INT, 4 * from);
    }

    function axes() {
      gl.disable(gl.DEPTH_TEST);
      gl.uniform1f(at.swing, 0);
      point("rest", buffers.axes, 3, gl.FLOAT, false);
      for (const name of ["moved", "kind"]) gl.disableVertexAttribArray(gl.getAttribLocation(shader, name));
      gl.uniform4f(at.line, 0.75, 0.1, 0.1, 1);
      gl.drawArrays(gl.LINES, 0, 6);
    }

    function place(seen, aspect) {
      scene.axes.forEach((axis, k) => {
        const tip = [...scene.output.map((x, i) => x + 0.115 * scene.size * axis[i]), 1];
        const clip = [0, 1, 3].map((row) => tip.reduce((sum, x, column) => sum + seen.matrix[4 * column + row] * x, 0));
        labels[k].style.left = `${50 + (50 * clip[0]) / clip[2]}%`;
        labels[k].style.top = `${50 - (50 * clip[1]) / clip[2]}%`;
      });
    }

    function pan(right, up) {
      const seen = camera(state.view, 1), step = state.view.distance * 0.45;
      state.view.target = state.view.target.map((x, i) => x - step * (right * seen.right[i] - up * seen.up[i]));
    }

    return { state, show, setMode, look, turn, zoom, pan, draw };
  }

  return { create };
})();
