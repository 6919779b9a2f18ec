"use strict";
// Shapes to be turned and moved. The geometry goes to the graphics card once; a shape is its 16-bit displacements.
(() => {
  const VERTEX = `#version 300 es
    in vec3 at, move, outward;
    uniform mat3 turn; uniform vec2 zoom; uniform float part, tint, dots;
    out vec3 place; out float value;
    void main() {
      place = turn * (at + part * move);
      value = tint * dot(move, outward);
      gl_Position = vec4(place.xy * zoom, -0.4 * place.z - 0.02 * dots, 1.0);
      gl_PointSize = dots;
    }`;
  const FRAGMENT = `#version 300 es
    precision highp float;
    in vec3 place; in float value; out vec4 colour;
    uniform float dots;
    vec3 hue(float v) {
      float a = abs(v);
      vec3 middle = v > 0.0 ? vec3(0.96, 0.65, 0.51) : vec3(0.57, 0.77, 0.87);
      vec3 far = v > 0.0 ? vec3(0.70, 0.09, 0.17) : vec3(0.13, 0.40, 0.67);
      return a < 0.5 ? mix(vec3(0.95), middle, 2.0 * a) : mix(middle, far, 2.0 * a - 1.0);
    }
    void main() {
      if (dots > 0.0) {
        if (distance(gl_PointCoord, vec2(0.5)) > 0.5) discard;
        colour = vec4(0.1, 0.1, 0.1, 1.0);
        return;
      }
      vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
      colour = vec4(hue(clamp(value, -1.0, 1.0)) * (0.6 + 0.4 * abs(normal.z)), 1.0);
    }`;

  function program(gl) {
    const made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made));
    gl.useProgram(made);
    return made;
  }

  function begin(place, data) {
    const canvas = page.element("canvas", { tabIndex: 0 });
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "A surface to be turned: drag, arrow keys; wheel, plus and minus for its size");
    const gl = canvas.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });
    if (!gl) return; // the moving pictures stay
    const made = program(gl), at = (name) => gl.getUniformLocation(made, name);
    const uniform = Object.fromEntries(["turn", "zoom", "part", "tint", "dots"].map((name) => [name, at(name)]));
    const attribute = (name, values, type, size, kind = gl.STATIC_DRAW) => {
      const buffer = gl.createBuffer(), where = gl.getAttribLocation(made, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, values, kind);
      gl.enableVertexAttribArray(where);
      gl.vertexAttribPointer(where, size, type, type !== gl.FLOAT, 0, 0);
      return buffer;
    };

    const surface = gl.createVertexArray();
    gl.bindVertexArray(surface);
    const points = page.integers(data.points, Int16Array);
    attribute("at", points, gl.SHORT, 3);
    attribute("outward", page.integers(data.out, Int8Array), gl.BYTE, 3);
    const moves = data.shapes.map((shape) => page.integers(shape.move, Int16Array));
    const moving = attribute("move", moves[0], gl.SHORT, 3, gl.DYNAMIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    const faces = page.integers(data.faces, Uint16Array);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
    const stray = gl.createVertexArray();
    gl.bindVertexArray(stray);
    attribute("at", new Float32Array(3), gl.FLOAT, 3);
    const strayAt = gl.getParameter(gl.ARRAY_BUFFER_BINDING);
    attribute("move", new Float32Array(3), gl.FLOAT, 3);
    const strayMove = gl.getParameter(gl.ARRAY_BUFFER_BINDING);

    let [wide, high] = [0, 0]; // farthest from the axis and along it
    for (let k = 0; k < points.length; k += 3) {
      wide = Math.max(wide, Math.hypot(points[k], points[k + 1]) / 32767);
      high = Math.max(high, Math.abs(points[k + 2]) / 32767);
    }
    const state = { shape: 0, phase: 0, speed: 1, size: 1, zoom: 1, playing: !page.still, old: true };
    let [pitch, yaw] = data.view.map((degrees) => (degrees * Math.PI) / 180);
    let tags = [];

    // controls
    const buttons = data.shapes.map((shape, k) => {
      const button = page.element("button", { type: "button", textContent: shape.name });
      button.addEventListener("click", () => choose(k));
      return button;
    });
    const play = page.element("button", { type: "button", textContent: "pause" });
    play.addEventListener("click", () => { state.playing = !state.playing; play.textContent = state.playing ? "pause" : "play"; });
    play.textContent = state.playing ? "pause" : "play";
    const [speed] = page.range("speed", { min: 0.1, max: 3, step: 0.1, value: 1 }, (value) => { state.speed = value; });
    const [size] = page.range("size", { min: 0, max: 3, step: 0.05, value: 1 }, (value) => { state.size = value; state.old = true; tell(); });
    const words = page.element("span");
    const bar = page.element("div", { className: "bar" }, play, speed, size, words);
    place.append(page.element("div", { className: "bar" }, ...buttons), canvas, bar);
    place.classList.add("on");

    function choose(k) {
      const shape = data.shapes[k], points = shape.strays || [];
      state.shape = k;
      state.old = true;
      buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(i === k)));
      gl.bindBuffer(gl.ARRAY_BUFFER, moving);
      gl.bufferData(gl.ARRAY_BUFFER, moves[k], gl.DYNAMIC_DRAW);
      gl.bindBuffer(gl.ARRAY_BUFFER, strayAt);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points.flatMap((one) => one.at)), gl.DYNAMIC_DRAW);
      gl.bindBuffer(gl.ARRAY_BUFFER, strayMove);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points.flatMap((one) => one.move)), gl.DYNAMIC_DRAW);
      tags.forEach((tag) => tag.remove());
      tags = points.filter((one) => one.label).map((one) => page.element("span", { className: "tag", textContent: one.label }));
      place.append(...tags);
      tell();
    }
    // what the picture exaggerates, and what its colours mean
    function tell() {
      const shape = data.shapes[state.shape];
      words.replaceChildren();
      if (!shape.still) {
        words.append(`largest displacement drawn ${Number((100 * state.size * data.share).toPrecision(2))} % of the size; red outward, blue inward`);
        return;
      }
      const drawn = shape.flat ? "" : `; drawn ${Number(((state.size * data.swing * data.reach) / shape.metres).toPrecision(2))} times`;
      const most = Math.max(Math.abs(shape.least), Math.abs(shape.most));
      const end = (value) => `${Number(value.toPrecision(3))} ${shape.unit} `;
      words.append(end(-most), page.element("span", { className: "colours" }), ` ${end(most)}`);
      words.append(`(found from ${end(shape.least)}to ${end(shape.most).trim()})${drawn}`);
      if (shape.strays.length) words.append(`; dots: ${shape.strays.length} stray points of the survey`);
    }

    // turning
    const held = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      held.set(event.pointerId, [event.clientX, event.clientY]);
      if (event.isTrusted) canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      const from = held.get(event.pointerId);
      if (!from) return;
      const to = [event.clientX, event.clientY];
      if (held.size === 2) {
        const other = [...held].find(([id]) => id !== event.pointerId)[1];
        const apart = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]);
        scale(apart(to) / Math.max(1, apart(from)));
      } else turn((from[0] - to[0]) * 0.01, (to[1] - from[1]) * 0.01);
      held.set(event.pointerId, to);
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => held.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => { event.preventDefault(); scale(Math.exp(-0.0015 * event.deltaY)); }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
      if (step) turn(...step);
      else if (event.key === "+" || event.key === "-") scale(event.key === "+" ? 1.1 : 1 / 1.1);
      else return;
      event.preventDefault();
    });
    function turn(around, over) {
      yaw += around;
      pitch = Math.max(-Math.PI / 2, Math.min(Math.PI / 2, pitch + over));
      state.old = true;
    }
    function scale(factor) {
      state.zoom = Math.max(0.3, Math.min(20, state.zoom * factor));
      state.old = true;
    }

    function draw(seconds) {
      const shape = data.shapes[state.shape], resized = page.fit(canvas, place.clientWidth < 520 ? 0.9 : 0.6);
      const plays = state.playing && !shape.still;
      if (!(plays || state.old || resized)) return;
      state.old = false;
      if (plays) state.phase += (2 * Math.PI * state.speed * seconds) / 1.6;
      const part = state.size * data.swing * (shape.still ? 1 : Math.cos(state.phase));
      const [c, s, ce, se] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
      const near = [ce * c, ce * s, se], right = [-s, c, 0], up = [-se * c, -se * s, ce];
      const room = state.size * data.swing, tall = high * ce + wide * Math.abs(se) + room;
      const fit = 0.96 * state.zoom * Math.min(canvas.width / (wide + room), canvas.height / tall);
      const zoom = [fit / canvas.width, fit / canvas.height];
      gl.viewport(0, 0, canvas.width, canvas.height);
      gl.enable(gl.DEPTH_TEST);
      gl.clearColor(1, 1, 1, 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix3fv(uniform.turn, false, [0, 1, 2].flatMap((k) => [right[k], up[k], near[k]]));
      gl.uniform2fv(uniform.zoom, zoom);
      gl.uniform1f(uniform.part, shape.flat ? 0 : part);
      gl.uniform1f(uniform.tint, shape.tint * (shape.still ? 1 : Math.cos(state.phase)));
      gl.uniform1f(uniform.dots, 0);
      gl.bindVertexArray(surface);
      gl.drawElements(gl.TRIANGLES, faces.length, gl.UNSIGNED_SHORT, 0);
      const points = shape.strays || [];
      if (!points.length) return;
      gl.uniform1f(uniform.dots, 9 * Math.min(2, window.devicePixelRatio || 1));
      gl.bindVertexArray(stray);
      gl.drawArrays(gl.POINTS, 0, points.length);
      const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      points.filter((one) => one.label).forEach((one, k) => {
        const p = one.at.map((x, i) => x + part * one.move[i]);
        tags[k].style.left = `${canvas.offsetLeft + 0.5 * canvas.clientWidth * (1 + zoom[0] * dot(right, p))}px`;
        tags[k].style.top = `${canvas.offsetTop + 0.5 * canvas.clientHeight * (1 - zoom[1] * dot(up, p))}px`;
        tags[k].style.opacity = dot(near, p) > -0.2 ? 1 : 0.35;
      });
    }
    choose(0);
    page.clock(canvas, draw);
  }
  page.start("shapes", begin);
})();
