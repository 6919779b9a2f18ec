"use strict";
// The value nearest to the pointer, in words; the picture itself stays as it was drawn.
(() => {
  const NEAR = 14; // pixels
  function begin(place, data) {
    const image = place.querySelector("img"), tip = page.element("div", { className: "tip", hidden: true });
    const mark = page.element("div", { className: "mark", hidden: true });
    place.append(mark, tip);
    const text = (value) => (typeof value === "number" ? String(value).replace("e", " × 10^") : value);
    function show(event) {
      const box = image.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top;
      let best = null, least = NEAR;
      for (const series of data)
        for (const row of series.rows) {
          const away = Math.hypot(row[0] * box.width - x, row[1] * box.height - y);
          if (away < least) [best, least] = [[series, row], away];
        }
      tip.hidden = mark.hidden = !best;
      if (!best) return;
      const [series, row] = best, lines = series.name ? [series.name] : [];
      row.slice(2).forEach((value, k) => lines.push(`${series.axes[k]}: ${text(value)}`));
      tip.replaceChildren(...lines.flatMap((line, k) => (k ? [page.element("br"), line] : [line])));
      const left = image.offsetLeft + row[0] * box.width, top = image.offsetTop + row[1] * box.height;
      Object.assign(mark.style, { left: `${left}px`, top: `${top}px` });
      const over = row[0] > 0.6;
      Object.assign(tip.style, { left: `${left + (over ? -10 : 10)}px`, top: `${top + 8}px`, transform: over ? "translateX(-100%)" : "" });
    }
    for (const kind of ["pointermove", "pointerdown"]) image.addEventListener(kind, show);
    image.addEventListener("pointerleave", () => { tip.hidden = mark.hidden = true; });
  }
  page.start("hover", begin);
})();
