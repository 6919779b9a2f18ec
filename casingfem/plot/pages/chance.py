"""The page on chances: probability of a dangerous speed, splits of pairs, importance of inputs, the worst casings."""

from typing import Any

from casingfem.plot.chance import figure_importance, figure_probability, figure_splits_of
from casingfem.plot.page import Picture, Section, Table, Verdict, origin, render_page

PROBABLE = "Probability that the rim touches and closed contact grows, over speed. Band: 95 % interval."
SPLITS = "Splits of the lowest pairs over all casings."
MATTERS = "Share of the variance that each input causes: alone, and with all that it does together with others."
LIKELY = 0.05  # of the casings: more is bad


def chance_page(name: str, found: Any, runs: str = "") -> str:
    """HTML of the page on the draws of a scene, `found` of class `casingfem.chance.result.Chance`, and of its runs."""
    speeds, pairs, importance = found.speeds(), found.summary(), found.importance()
    names = [f"n = {row['n']}, m = {row['m']}" for row in pairs]
    draws = found.draws()
    worst = [draws[number] for number in found.worst.tolist()]
    sections = [
        Section("Dangerous speeds", figures=(Picture.of(figure_probability(speeds), PROBABLE),)),
        Section(
            "Splits of the pairs",
            figures=(Picture.of(figure_splits_of(found.of_pairs("split"), names), SPLITS),),
            tables=(Table.of("Quantiles over the casings.", found.COLUMNS, pairs),),
        ),
    ]
    if importance:
        picture = Picture.of(figure_importance(importance), MATTERS)
        sections.append(Section("Importance of the inputs", figures=(picture,)))
    if worst:
        heads = ("rank", "draw", "growth [1/s]", "at [Hz]", "gap [mm]", "largest split [%]", "n", "m")
        rows = tuple(
            (k, row["draw"], f"{row['growth_1_s']:.4g}", f"{row['at_hz']:.4g}", f"{1e3 * row['gap_m']:.4g}",
             f"{100 * row['split_rel']:.3g}", row["n"], row["m"])
            for k, row in enumerate(worst, 1)
        )  # fmt: skip
        caption = "The worst casings. Folder worst/NN has the study, the bases and the scene of each."
        sections.append(Section("Worst casings", tables=(Table(caption, heads, rows),)))
    source = {key: value for key, value in found.drawn.given.source.items() if key != "study"}  # the scene names it
    return render_page(f"Chances of {name}", sections, verdict=verdict(found, runs), source=origin(source))


def verdict(found: Any, runs: str) -> Verdict:
    """Probability of a dangerous speed, its uncertainty, and next steps; `runs` is a sentence on the runs."""
    answer, *others = found.facts.items()
    facts = (*others, *([("Runs", runs)] if runs else []))
    chance = found.any_speed
    state = "good" if chance.high < LIKELY else "bad" if chance.low > LIKELY else "open"
    sure = (
        "The intervals include only the uncertainty from the number of draws. Growth is that of a contact that stays "
        "closed, with the mean frequency of each pair; time simulations decide whether the motion grows."
    )
    further = (
        "Run the worst casings: `casingfem interactions worst/01/scene.toml`. More draws narrow the intervals: raise "
        "draws and run the same command again."
    )
    return Verdict(found=answer[1], sure=sure, further=further, facts=facts, state=state)
