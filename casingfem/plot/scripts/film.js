"use strict";
// A rub that plays: rim and tips on one canvas, force and gap over the whole run on another, a slider over the frames.
(() => {
  const LINES = 360;

  function begin(place, data) {
    const time = page.integers(data.time, Float32Array), turned = page.integers(data.turned, Float32Array);
    const [cos, sin, gap, force] = ["cos", "sin", "gap", "force"].map((name) => page.floats(data[name]));
    const profile = page.floats(data.profile), count = time.length, harmonics = data.n.length, tips = data.angle.length;
    const waves = data.n.map((n) => [
      Float32Array.from({ length: LINES }, (_, k) => Math.cos((2 * Math.PI * n * k) / LINES)),
      Float32Array.from({ length: LINES }, (_, k) => Math.sin((2 * Math.PI * n * k) / LINES)),
    ]);
    const traces = data.traces.map((one) => ({
      name: one.name, time: page.integers(one.time, Float32Array), values: page.floats(one.values),
    }));
    const stage = page.element("canvas"), beside = page.element("canvas");
    stage.setAttribute("role", "img");
    stage.setAttribute("aria-label", "The rim and the tips before it");
    beside.setAttribute("role", "img");
    beside.setAttribute("aria-label", "Force and gap over the run; choose an instant");
    const state = { frame: 0, speed: 1, playing: !page.still, still: true, old: true };

    const play = page.element("button", { type: "button", textContent: state.playing ? "pause" : "play" });
    play.addEventListener("click", () => { state.playing = !state.playing; play.textContent = state.playing ? "pause" : "play"; });
    const [speed] = page.range("speed", { min: 0.1, max: 4, step: 0.1, value: 1 }, (value) => { state.speed = value; });
    const [slider, where] = page.range("", { min: 0, max: count - 1, step: 1, value: 0 }, (value) => {
      state.playing = false;
      play.textContent = "play";
      show(value);
    }, true);
    where.setAttribute("aria-label", "instant");
    const turn = page.element("button", { type: "button", textContent: "turn with the casing" });
    turn.setAttribute("aria-pressed", "false");
    turn.addEventListener("click", () => {
      state.still = !state.still;
      turn.setAttribute("aria-pressed", String(!state.still));
      state.old = true;
    });
    const words = page.element("span");
    const films = page.element("div", { className: "films" }, page.element("div", {}, stage), page.element("div", {}, beside));
    place.append(films, page.element("div", { className: "bar" }, slider, play, speed, turn, words));
    place.classList.add("on");

    function show(frame) {
      state.frame = frame;
      state.old = true;
      where.value = Math.floor(frame);
    }
    // radial deviation [m] of the rim at place k of LINES on the casing
    function rim(frame, k) {
      let sum = profile.length ? profile[Math.round((k * profile.length) / LINES) % profile.length] : 0;
      for (let h = 0; h < harmonics; h++)
        sum += cos[frame * harmonics + h] * waves[h][0][k] + sin[frame * harmonics + h] * waves[h][1][k];
      return sum;
    }
    function drawStage(frame) {
      const pen = stage.getContext("2d"), w = stage.width, h = stage.height, middle = [w / 2, h / 2];
      const unit = (0.4 * Math.min(w, h)) / data.radius, thick = Math.max(1, w / 400);
      const offset = state.still ? turned[frame] : 0;
      const at = (angle, radial) => {
        const r = unit * (data.radius + data.scale * radial);
        return [middle[0] + r * Math.cos(angle), middle[1] - r * Math.sin(angle)];
      };
      pen.fillStyle = "#fff";
      pen.fillRect(0, 0, w, h);
      pen.lineWidth = thick;
      pen.strokeStyle = "#c8c8c8";
      pen.beginPath();
      pen.arc(...middle, unit * data.radius, 0, 2 * Math.PI);
      pen.stroke();
      pen.strokeStyle = "#0072B2";
      pen.lineWidth = 2 * thick;
      pen.beginPath();
      for (let k = 0; k <= LINES; k++) pen.lineTo(...at((2 * Math.PI * k) / LINES + offset, rim(frame, k % LINES)));
      pen.stroke();
      pen.beginPath();
      const mark = rim(frame, 0), long = (0.06 * data.radius) / data.scale;
      pen.moveTo(...at(offset, mark));
      pen.lineTo(...at(offset, mark + long));
      pen.stroke();
      for (let j = 0; j < tips; j++) {
        const angle = data.angle[j] + (state.still ? 0 : -turned[frame]), on = data.angle[j] - turned[frame];
        const k = ((Math.round((on / (2 * Math.PI)) * LINES) % LINES) + LINES) % LINES;
        const top = at(angle, rim(frame, k) - gap[frame * tips + j]), touching = force[frame * tips + j] > 0;
        pen.strokeStyle = "#555";
        pen.lineWidth = (tips > 8 ? 2 : 5) * thick;
        pen.beginPath();
        pen.moveTo(middle[0] + 0.45 * unit * data.radius * Math.cos(angle), middle[1] - 0.45 * unit * data.radius * Math.sin(angle));
        pen.lineTo(...top);
        pen.stroke();
        pen.fillStyle = touching ? "#b2182b" : "#D9A400";
        pen.beginPath();
        pen.arc(...top, (touching ? 5 : 3.5) * thick, 0, 2 * Math.PI);
        pen.fill();
      }
    }
    function drawBeside(frame) {
      const pen = beside.getContext("2d"), w = beside.width, h = beside.height, ratio = w / beside.clientWidth;
      const left = 58 * ratio, right = w - 8 * ratio, size = (h - 30 * ratio) / traces.length;
      const last = traces[0].time[traces[0].time.length - 1], first = Math.min(0, traces[0].time[0]);
      const across = (t) => left + ((t - first) / (last - first || 1)) * (right - left);
      pen.fillStyle = "#fff";
      pen.fillRect(0, 0, w, h);
      pen.font = `${11 * ratio}px system-ui, sans-serif`;
      traces.forEach((one, row) => {
        const top = row * size + 20 * ratio, bottom = (row + 1) * size;
        let low = 0, high = 0;
        for (const value of one.values) [low, high] = [Math.min(low, value), Math.max(high, value)];
        const up = (value) => bottom - ((value - low) / (high - low || 1)) * (bottom - top);
        pen.strokeStyle = "#bbb";
        pen.lineWidth = ratio;
        pen.beginPath();
        pen.moveTo(left, up(0));
        pen.lineTo(right, up(0));
        pen.stroke();
        pen.strokeStyle = row ? "#0072B2" : "#D55E00";
        pen.beginPath();
        for (let k = 0; k < one.values.length; k++) pen.lineTo(across(one.time[k]), up(one.values[k]));
        pen.stroke();
        pen.fillStyle = "#333";
        pen.textAlign = "left";
        pen.fillText(one.name, left + 6 * ratio, top - 7 * ratio);
        pen.textAlign = "right";
        pen.fillText(Number(high.toPrecision(3)), left - 4 * ratio, top + 8 * ratio);
        pen.fillText(Number(low.toPrecision(3)), left - 4 * ratio, bottom);
      });
      pen.fillStyle = "#333";
      pen.textAlign = "left";
      pen.fillText(Number(first.toPrecision(3)), left, h - 10 * ratio);
      pen.textAlign = "right";
      pen.fillText(`${Number(last.toPrecision(4))} s`, right, h - 10 * ratio);
      pen.strokeStyle = "#1b1b1b";
      pen.beginPath();
      pen.moveTo(across(time[frame]), 18 * ratio);
      pen.lineTo(across(time[frame]), h - 26 * ratio);
      pen.stroke();
    }
    function choose(event) {
      if (event.type === "pointermove" && !event.buttons) return;
      const box = beside.getBoundingClientRect(), all = traces[0].time, last = all[all.length - 1], first = Math.min(0, all[0]);
      const t = first + ((event.clientX - box.left - 58) / (box.width - 66)) * (last - first);
      let best = 0;
      for (let k = 1; k < count; k++) if (Math.abs(time[k] - t) < Math.abs(time[best] - t)) best = k;
      state.playing = false;
      play.textContent = "play";
      show(best);
    }
    for (const kind of ["pointerdown", "pointermove"]) beside.addEventListener(kind, choose);

    function draw(seconds) {
      const narrow = place.clientWidth < 520;
      films.style.gridTemplateColumns = narrow ? "1fr" : "1fr 1fr";
      const a = page.fit(stage, 1), b = page.fit(beside, narrow ? 0.7 : 1);
      if (state.playing) show((state.frame + 30 * state.speed * seconds) % count);
      if (!(state.old || a || b)) return;
      state.old = false;
      const frame = Math.min(count - 1, Math.floor(state.frame));
      drawStage(frame);
      drawBeside(frame);
      let total = 0, least = Infinity;
      for (let j = 0; j < tips; j++) [total, least] = [total + force[frame * tips + j], Math.min(least, gap[frame * tips + j])];
      const stretch = data.stretches.filter((start) => start <= frame).length;
      const part = data.stretches.length > 1 ? `stretch ${stretch} of ${data.stretches.length}, ` : "";
      words.textContent = `${part}t = ${time[frame].toFixed(5)} s, force ${total.toPrecision(3)} N, gap ${(1e3 * least).toFixed(4)} mm`;
    }
    page.clock(films, draw);
  }
  page.start("film", begin);
})();
