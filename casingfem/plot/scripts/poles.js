"use strict";
// Stabilisation diagram, mode indicator, and one channel with its fit; clicks choose poles, whose list becomes a file.
(() => {
  const NEAR = 12; // pixels
  const GREY = "#8a8a8a", BLUE = "#0072B2", GREEN = "#009E73", RED = "#D55E00", BLACK = "#000000";

  function begin(place, data) {
    const lines = page.integers(data.lines, Float32Array), freq = page.integers(data.freq, Float32Array);
    const order = page.integers(data.order, Uint8Array), stable = page.integers(data.stable, Uint8Array);
    const zeta = page.integers(data.zeta, Float32Array), fit = page.integers(data.fit, Uint8Array);
    const curves = data.curves.map((curve) => page.floats(curve));
    const whole = [lines[0], lines[lines.length - 1]], top = Math.max(...order, 1) + 1;
    const state = { from: whole[0], to: whole[1], channel: 0, picks: [], drag: null, old: true, parts: null };
    const names = ["Stabilisation diagram: choose poles", "Magnitude of one channel and its fit", "Phase of it"];
    const [stage, size, phase] = names.map((name) => {
      const canvas = page.element("canvas");
      canvas.setAttribute("role", "img");
      canvas.setAttribute("aria-label", name);
      return canvas;
    });
    const words = page.element("span"), list = page.element("p", { className: "source" });
    const button = (text, heard) => {
      const made = page.element("button", { type: "button", textContent: text });
      made.addEventListener("click", () => { heard(); redraw(); });
      return made;
    };
    const choose = page.element("select");
    data.channels.forEach((one, k) => choose.append(page.element("option", { value: k, textContent: one.name })));
    choose.addEventListener("change", () => { state.channel = Number(choose.value); state.parts = null; redraw(); });
    const ends = ["from", "to"].map((end) => {
      const input = page.element("input", { type: "number", step: "any", value: state[end].toFixed(3) });
      input.addEventListener("change", () => {
        if (Number.isFinite(input.valueAsNumber)) state[end] = input.valueAsNumber;
        if (!(state.from < state.to)) [state.from, state.to] = whole;
        redraw();
      });
      return input;
    });
    const bar = page.element("div", { className: "bar" },
      page.element("label", {}, "from", ends[0]), page.element("label", {}, "to", ends[1], "Hz"),
      button("whole band", () => { [state.from, state.to] = whole; }));
    if (data.pick) bar.append(
      button("take the modes found", () => { state.picks = data.modes.map((mode) => ({ freq: mode.freq, zeta: mode.zeta })); sort(); }),
      button("clear", () => { state.picks = []; }),
      button("save picks.csv", save));
    place.append(stage, bar, page.element("div", { className: "bar" }, words), list,
      page.element("div", { className: "bar" }, page.element("label", {}, "channel", choose)), size, phase);
    place.classList.add("on");

    function sort() { state.picks.sort((a, b) => a.freq - b.freq); }
    function save() {
      const rows = state.picks.map((pick) => `${pick.freq.toPrecision(8)},${pick.zeta.toPrecision(4)}`);
      const text = [`# picked by hand from ${data.name}`, "freq_hz,zeta", ...rows, ""].join("\n");
      const link = page.element("a", { download: "picks.csv", href: URL.createObjectURL(new Blob([text], { type: "text/csv" })) });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 1000);
      place.saved = text;
    }
    const across = (canvas, hz) => ((hz - state.from) / (state.to - state.from)) * canvas.width;
    const hertz = (canvas, event) => {
      const box = canvas.getBoundingClientRect();
      return state.from + ((event.clientX - box.left) / box.width) * (state.to - state.from);
    };
    const up = (n) => stage.height * (1 - n / top);

    // the pole nearest to a place of the canvas, if one is near
    function nearest(event) {
      const box = stage.getBoundingClientRect(), ratio = stage.width / box.width;
      const x = (event.clientX - box.left) * ratio, y = (event.clientY - box.top) * ratio;
      let best = -1, least = NEAR * ratio;
      for (let k = 0; k < freq.length; k++) {
        const away = Math.hypot(across(stage, freq[k]) - x, up(order[k]) - y);
        if (away < least) [best, least] = [k, away];
      }
      return best;
    }
    function click(event) {
      if (!data.pick) return;
      const hz = hertz(stage, event), reach = (NEAR / stage.clientWidth) * (state.to - state.from), k = nearest(event);
      const wanted = k < 0 ? hz : freq[k];
      const there = state.picks.findIndex((pick) => Math.abs(pick.freq - wanted) < 0.5 * reach);
      if (there >= 0) state.picks.splice(there, 1);
      else if (k >= 0) state.picks.push({ freq: freq[k], zeta: zeta[k] });
      sort();
    }
    stage.addEventListener("pointerdown", (event) => { state.drag = { at: event.clientX, hz: hertz(stage, event), now: null }; });
    stage.addEventListener("pointermove", (event) => {
      if (state.drag && Math.abs(event.clientX - state.drag.at) > 6) { state.drag.now = hertz(stage, event); redraw(); }
    });
    stage.addEventListener("pointerup", (event) => {
      const drag = state.drag;
      state.drag = null;
      if (drag && drag.now !== null) [state.from, state.to] = [drag.hz, hertz(stage, event)].sort((a, b) => a - b);
      else click(event);
      redraw();
    });
    stage.addEventListener("pointerleave", () => { state.drag = null; redraw(); });
    stage.addEventListener("dblclick", () => { [state.from, state.to] = whole; redraw(); });

    function clean(canvas, marks, label) {
      const pen = canvas.getContext("2d"), scale = canvas.width / canvas.clientWidth;
      pen.fillStyle = "#fff";
      pen.fillRect(0, 0, canvas.width, canvas.height);
      pen.font = `${11 * scale}px system-ui, sans-serif`;
      pen.lineWidth = scale;
      pen.strokeStyle = "#e4e4e4";
      pen.fillStyle = "#555";
      for (const [y, text] of marks) {
        pen.beginPath();
        pen.moveTo(0, y);
        pen.lineTo(canvas.width, y);
        pen.stroke();
        pen.fillText(text, 3 * scale, y - 3 * scale);
      }
      const step = Math.pow(10, Math.floor(Math.log10((state.to - state.from) / 4)));
      const every = [1, 2, 5, 10].map((k) => k * step).find((one) => (state.to - state.from) / one <= 8) || 10 * step;
      for (let hz = Math.ceil(state.from / every) * every; hz <= state.to; hz += every) {
        const x = across(canvas, hz);
        pen.beginPath();
        pen.moveTo(x, 0);
        pen.lineTo(x, canvas.height);
        pen.stroke();
        pen.fillText(String(Number(hz.toPrecision(7))), x + 2 * scale, canvas.height - 3 * scale);
      }
      pen.fillText(label, canvas.width - pen.measureText(label).width - 3 * scale, 12 * scale);
      return [pen, scale];
    }
    function stroke(pen, canvas, values, height, colour, width, dash = [], shown = null) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.setLineDash(dash);
      pen.beginPath();
      let open = false;
      for (let k = 0; k < lines.length; k++) {
        if (shown && !shown[k]) { open = false; continue; }
        const x = across(canvas, lines[k]);
        if (x < -canvas.width || x > 2 * canvas.width) continue;
        if (open) pen.lineTo(x, height(values[k]));
        else pen.moveTo(x, height(values[k]));
        open = true;
      }
      pen.stroke();
      pen.setLineDash([]);
    }
    function seen(values) {
      let low = Infinity, high = -Infinity;
      for (let k = 0; k < lines.length; k++)
        if (lines[k] >= state.from && lines[k] <= state.to) {
          low = Math.min(low, values[k]);
          high = Math.max(high, values[k]);
        }
      return low < high ? [low, high] : [low - 1, low + 1];
    }
    function upright(pen, canvas, hz, colour, width, dash = []) {
      const x = across(canvas, hz);
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.setLineDash(dash);
      pen.beginPath();
      pen.moveTo(x, 0);
      pen.lineTo(x, canvas.height);
      pen.stroke();
      pen.setLineDash([]);
    }
    function drawStage() {
      const every = Math.max(1, Math.ceil(top / 8));
      const marks = Array.from({ length: Math.floor((top - 1) / every) }, (_, k) => [up((k + 1) * every), String((k + 1) * every)]);
      const [pen, scale] = clean(stage, marks, "model order; grey: mode indicator");
      const [low, high] = seen(curves[0]), least = Math.min(low, ...curves.map((curve) => seen(curve)[0]));
      const height = (value) => stage.height * (0.98 - (0.93 * (value - least)) / (high - least));
      curves.forEach((curve, k) => stroke(pen, stage, curve, height, GREY, (k ? 0.7 : 1.4) * scale));
      for (const mode of data.modes) upright(pen, stage, mode.freq, RED, scale, mode.sure ? [] : [4 * scale, 4 * scale]);
      for (let k = 0; k < freq.length; k++) {
        const x = across(stage, freq[k]), y = up(order[k]), r = 3 * scale;
        if (x < 0 || x > stage.width) continue;
        pen.strokeStyle = BLUE;
        pen.fillStyle = GREEN;
        pen.lineWidth = 0.8 * scale;
        pen.beginPath();
        if (stable[k]) {
          pen.arc(x, y, r, 0, 2 * Math.PI);
          pen.fill();
        } else {
          pen.moveTo(x - r, y - r);
          pen.lineTo(x + r, y + r);
          pen.moveTo(x - r, y + r);
          pen.lineTo(x + r, y - r);
          pen.stroke();
        }
      }
      for (const pick of state.picks) {
        const x = across(stage, pick.freq), r = 6 * scale;
        upright(pen, stage, pick.freq, BLACK, 1.6 * scale);
        pen.fillStyle = BLACK;
        pen.beginPath();
        pen.moveTo(x - r, 0);
        pen.lineTo(x + r, 0);
        pen.lineTo(x, 1.5 * r);
        pen.fill();
      }
      if (state.drag && state.drag.now !== null) {
        const [a, b] = [state.drag.hz, state.drag.now].map((hz) => across(stage, hz));
        pen.fillStyle = "rgba(0,114,178,.15)";
        pen.fillRect(Math.min(a, b), 0, Math.abs(b - a), stage.height);
      }
    }
    function drawChannel() {
      const one = data.channels[state.channel];
      if (!state.parts) state.parts = {
        size: page.floats(one.size), fitted: page.floats(one.fitted),
        phase: page.floats(one.phase, Int8Array), turned: page.floats(one.turned, Int8Array),
      };
      const { size: values, fitted, phase: angle, turned } = state.parts, [low, high] = seen(values);
      const height = (value) => size.height * (0.95 - (0.9 * (value - low)) / (high - low));
      const marks = [];
      for (let ten = Math.ceil(low); ten <= high; ten++) marks.push([height(ten), `10^${ten}`]);
      const [pen, scale] = clean(size, marks, `magnitude${data.unit ? ` [${data.unit}]` : ""}: measured black, fit red`);
      stroke(pen, size, values, height, BLACK, scale);
      stroke(pen, size, fitted, height, RED, 1.4 * scale, [5 * scale, 3 * scale], fit);
      for (const pick of state.picks) upright(pen, size, pick.freq, GREY, scale);
      const degrees = (value) => phase.height * (0.5 - value / 400);
      const [ink] = clean(phase, [-180, -90, 0, 90, 180].map((d) => [degrees(d), `${d}`]), "phase [deg]");
      const dots = (part, colour, shown) => {
        ink.fillStyle = colour;
        for (let k = 0; k < lines.length; k++)
          if (!shown || shown[k]) ink.fillRect(across(phase, lines[k]) - 0.6 * scale, degrees(part[k]) - 0.6 * scale, 1.2 * scale, 1.2 * scale);
      };
      dots(angle, BLACK, null);
      dots(turned, RED, fit);
    }
    function redraw() {
      state.old = true;
      ends[0].value = state.from.toFixed(3);
      ends[1].value = state.to.toFixed(3);
      words.textContent = data.pick
        ? `${state.picks.length} picked. A click on a pole picks it or leaves it; dragging shows a band, a double click all.`
        : "Dragging shows a band, a double click all.";
      list.textContent = state.picks.map((pick) => `${pick.freq.toPrecision(7)} Hz`).join(", ");
    }
    redraw();
    page.clock(place, () => {
      const fresh = [page.fit(stage, 0.38), page.fit(size, 0.26), page.fit(phase, 0.14)].some(Boolean);
      if (!fresh && !state.old) return;
      state.old = false;
      drawStage();
      drawChannel();
    });
  }
  page.start("poles", begin);
})();
