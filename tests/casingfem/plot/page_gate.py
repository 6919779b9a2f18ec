"""The picture gate: what is refused in a figure, and in a page as a browser shows and prints it."""

import re
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure

from tests.casingfem.plot.browser import Tab

COUNTED = (
    "nodal diameters n", "mode", "measured mode", "computed mode", "model order", "number of the hit", "engine order",
    "casings",
)  # fmt: skip
A4, PHONE, DESK = 794, 380, 1400  # pixels across; A4 at 96 an inch
EXACT = 1e-9  # of an axis: less beyond its ends is rounding
TOUCH = 1.0  # pixels that two labels may share: their boxes are a little larger than their letters
REPR = re.compile(
    r"\b[A-Z]\w+\([a-z_]+=|\barray\(|<[\w.]+ object at|\bnp\.\w+\(|\bnan\b|\binf\b|\dL?[eE][+-]\d|\bNone\b"
)
WARNING = re.compile(r"Warning\b|Traceback")
WIDE = """(() => {
  const found = [], across = document.documentElement.clientWidth, seen = (e) => e.getClientRects().length > 0;
  if (document.documentElement.scrollWidth > across) found.push("the page is wider than the window");
  for (const e of document.querySelectorAll("img, canvas, table, pre, dl, figcaption")) {
    if (!seen(e)) continue;
    const box = e.closest(".scroll");
    if (box && !PRINT) continue;
    if (e.getBoundingClientRect().right > across + 1) found.push("cut at the right: " + e.tagName.toLowerCase());
    if (PRINT && e.scrollWidth > e.clientWidth + 1 && e.tagName === "PRE") found.push("cut at the right: pre");
  }
  for (const e of document.querySelectorAll("td.number, th.number")) {
    const lines = document.createRange();
    lines.selectNodeContents(e);
    if (seen(e) && e.textContent.split(" ").length < lines.getClientRects().length)
      found.push("a word over two lines: " + e.textContent.trim());
  }
  for (const head of document.querySelectorAll("th.number")) {
    const words = head.textContent.trim(), table = head.closest("table");
    const place = [...table.querySelectorAll("th")].findIndex((one) => one.textContent.trim() === "unit");
    const units = [...table.querySelectorAll("tbody tr")].map((row) => row.children[place]?.textContent.trim());
    if (PER_ROW.includes(words) && place >= 0 && units.every((unit) => /[^–]/.test(unit || ""))) continue;
    if (!/\\[|^\\d+$/.test(words) && !COUNTED.includes(words)) found.push("no unit: " + words);
  }
  for (const ends of document.querySelectorAll(".speeds .ends")) {
    const outer = [...ends.children].filter((e) => e.className !== "key");
    const tops = outer.map((e) => Math.round(e.getBoundingClientRect().top));
    if (new Set(tops).size > 1) found.push("ends of a strip of speeds on two lines");
  }
  for (const e of document.querySelectorAll("p, dd, td, th, figcaption, caption, summary, .notice")) {
    if (e.textContent.trim() && seen(e) && e.scrollWidth > e.clientWidth + 1 && !e.closest(".scroll"))
      found.push("text is cut: " + e.textContent.trim().slice(0, 40));
  }
  return found;
})()"""
NUMBERS = (  # columns of counts and shares, which have no unit
    "contact", "closings", "mode", "n", "n of the pole", "dominant n", "branch", "periods", "closes", "contacts",
    "multiplier", "confidence", "row", "sensor", "MAC", "plane", "rank", "seconds", "m", "purity",
    "contact, part of the time", "energy not accounted for", "pairs with", "updated: with", "COMAC before", "after",
    "references", "hit", "draw", "part of the time", "share of n", "pair", "modes", "channels",
)  # fmt: skip
PER_ROW = ("start", "value", "lower", "upper", "sigma", "change")  # columns whose unit is in each row's column "unit"


def faults_of(figure: Figure) -> list[str]:
    """What the gate refuses in a figure."""
    figure.draw_without_rendering()
    found = [fault for axes in figure.axes for fault in (*cut(axes), *unnamed(axes))]
    found += legends_over_data(figure) + overlaps(figure)
    whole, size = figure.get_tightbbox(), figure.get_size_inches()
    beyond = min(whole.x0, whole.y0) < -0.02 or np.any(size + 0.02 < [whole.x1, whole.y1])
    return found + (["a label is cut off"] if beyond else [])


def cut(axes: Axes) -> list[str]:
    """Curves and dots that reach beyond the axes; below, a logarithmic axis may end."""
    if axes.get_label() == "<colorbar>" or axes.name in ("3d", "polar"):
        return []
    found = []
    lines = [one for one in axes.lines if one.get_transform() == axes.transData and one.get_linestyle() != ":"]
    data = [(line.get_xdata(), line.get_ydata()) for line in lines if line.get_clip_on()]
    clouds = [cloud for cloud in axes.collections if isinstance(cloud, PathCollection)]
    data += [tuple(np.asarray(cloud.get_offsets()).T) for cloud in clouds]
    for values, limits, scale in ((0, axes.get_xlim(), axes.get_xscale()), (1, axes.get_ylim(), axes.get_yscale())):
        low, high = sorted(limits)
        slack = EXACT * (high - low)
        for pair in data:
            numbers = np.asarray(pair[values], float)
            known = numbers[np.isfinite(numbers)]
            over = known.size and known.max() > high + slack
            under = known.size and scale == "linear" and known.min() < low - slack
            if over or under:
                found.append(f"data cut off in {axes.get_ylabel()!r}")
    return sorted(set(found))


def unnamed(axes: Axes) -> list[str]:
    """Axes with numbers whose name has no unit and that do not count."""
    if axes.get_label() == "<colorbar>":
        return [] if "[" in axes.get_ylabel() else [f"no unit: {axes.get_ylabel()!r}"]
    if axes.name in ("3d", "polar") or not axes.axison:
        return []
    found = []
    beside = {"x": axes.get_shared_x_axes(), "y": axes.get_shared_y_axes()}
    for name, axis in (("x", axes.xaxis), ("y", axes.yaxis)):
        shared = beside[name].get_siblings(axes)
        label = next((one for other in (axes, *shared) if (one := getattr(other, f"get_{name}label")())), "")
        numbers = any(re.match(r"[-−+]?\d", tick.get_text()) for tick in axis.get_ticklabels() if tick.get_visible())
        alone = len(figure_grid(axes)) == 1 or label
        unit = re.search(r"\[(Hz|N)\]", label)
        if unit and axis.get_scale() == "linear" and max(map(abs, axis.get_view_interval())) >= 1e4:
            found.append(f"ten thousand {unit[1]} and more: {label!r}")
        if numbers and alone and "[" not in label and label not in COUNTED and not label.startswith("measured"):
            found.append(f"no unit: {label!r}")
    return found


def figure_grid(axes: Axes) -> list[Axes]:
    """Axes in the row of these: one name may serve a row."""
    spec = axes.get_subplotspec()
    others = [axes] if spec is None else [
        one for one in axes.figure.axes if (own := one.get_subplotspec()) is not None and own.rowspan == spec.rowspan
    ]  # fmt: skip
    return others


def legends_over_data(figure: Figure) -> list[str]:
    """Legends that lie over a panel."""
    panels = [axes.bbox for axes in figure.axes if axes.get_label() != "<colorbar>"]
    legends = [*figure.legends, *(one for axes in figure.axes if (one := axes.get_legend()) is not None)]
    boxes = [legend.get_window_extent() for legend in legends]
    over = any(shared(a, b) for a in boxes for b in panels)
    return ["legend over data"] if over else []


def overlaps(figure: Figure) -> list[str]:
    """Pairs of labels that overlap, of the whole figure."""
    texts = [text for axes in figure.axes for text in labels(axes)]
    texts += [text for legend in figure.legends for text in legend.get_texts()]
    boxes = [(text.get_text(), text.get_window_extent()) for text in texts]
    pairs = combinations(boxes, 2)
    return sorted({f"{a!r} over {b!r}" for (a, one), (b, other) in pairs if shared(one, other)})


def shared(a: Any, b: Any) -> bool:
    """Whether two boxes overlap by more than TOUCH."""
    wide, high = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
    return bool(wide > TOUCH and high > TOUCH)


def labels(axes: Axes) -> list[Any]:
    """Every visible text of some axes."""
    if axes.name == "3d" or not axes.axison:
        return [text for text in axes.texts if text.get_text()]
    texts = [*axes.texts, axes.title, axes._left_title, axes._right_title]
    for axis, limits in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        if not axis.get_visible():
            continue
        low, high = sorted(limits)
        slack = EXACT * (high - low)
        texts += [axis.label, axis.offsetText]
        for tick in axis.get_major_ticks():
            if axes.name == "polar" or low - slack <= tick.get_loc() <= high + slack:
                texts += [tick.label1, tick.label2]
    if axes.get_legend() is not None:
        texts += axes.get_legend().get_texts()
    return [text for text in texts if text.get_text() and text.get_visible()]


def page_faults(tab: Tab, file: Path) -> list[str]:
    """What the gate refuses in a page: on a desk, on a phone, on paper."""
    found: list[str] = []
    for width, media in ((DESK, "screen"), (PHONE, "screen"), (A4, "print")):
        tab.send("Emulation.setEmulatedMedia", media=media)
        tab.open(file, width)
        tab.run("document.querySelectorAll('details').forEach((one) => { one.open = true; })")
        script = WIDE.replace("PRINT", str(media == "print").lower()).replace("COUNTED", repr(list(NUMBERS)))
        script = script.replace("PER_ROW", repr(list(PER_ROW)))
        found += [f"{width} {media}: {fault}" for fault in tab.run(script)]
    tab.send("Emulation.setEmulatedMedia", media="screen")
    text = tab.run(
        "[...document.querySelectorAll('main :not(pre):not(code)')].filter((e) => !e.children.length)"
        ".map((e) => e.textContent).join(' | ')"
    )
    text = re.sub(r"\{.*?\}", "", re.sub(r"\s+", " ", text))
    found += [f"raw repr: {one[0]!r}" for one in [REPR.search(text)] if one]
    found += [f"text of a warning: {one[0]!r}" for one in [WARNING.search(text)] if one]
    return found + tab.heard
