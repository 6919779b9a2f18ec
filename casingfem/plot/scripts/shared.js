"use strict";
// What the scripts of a page share: packed numbers, elements, and a clock that stops while the page is hidden.
const page = {
  integers(coded, Type) {
    const bytes = Uint8Array.from(atob(coded), (letter) => letter.charCodeAt(0));
    return new Type(bytes.buffer);
  },
  floats(part, Type = Int16Array) {
    const whole = Type === Int16Array ? 32767 : 127;
    return Float32Array.from(page.integers(part.data, Type), (value) => (value / whole) * part.most);
  },
  element(tag, properties = {}, ...children) {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  },
  range(label, properties, heard, long = false) {
    const input = page.element("input", Object.assign({ type: "range" }, properties));
    if (long) input.className = "long";
    input.addEventListener("input", () => heard(Number(input.value)));
    return [page.element("label", { className: long ? "long" : "" }, label, input), input];
  },
  still: window.matchMedia("(prefers-reduced-motion: reduce)").matches,
  // calls draw(seconds since the last picture) for each picture while the element is in sight
  clock(element, draw) {
    let before = null, seen = false;
    const step = (now) => {
      if (!seen) return;
      draw(before === null ? 0 : Math.min(0.1, (now - before) / 1000));
      before = now;
      requestAnimationFrame(step);
    };
    new IntersectionObserver((entries) => {
      const was = seen;
      seen = entries[entries.length - 1].isIntersecting;
      before = null;
      if (seen && !was) requestAnimationFrame(step);
    }).observe(element);
  },
  // fits a canvas to its place on the page; returns whether its size changed
  fit(canvas, shape) {
    const ratio = Math.min(2, window.devicePixelRatio || 1), width = Math.round(canvas.clientWidth * ratio);
    const height = Math.round(canvas.clientWidth * shape * ratio);
    canvas.style.height = height / ratio + "px";
    if (!width || (canvas.width === width && canvas.height === height)) return false;
    canvas.width = width;
    canvas.height = height;
    return true;
  },
  start(name, begin) {
    for (const place of document.querySelectorAll(`[data-live="${name}"]`))
      begin(place, JSON.parse(place.querySelector("script").textContent));
  },
};
