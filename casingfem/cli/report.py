"""`casingfem report`: one page about studies and scenes."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from casingfem.cli.contact import is_scene, ran, require_solved
from casingfem.cli.progress import ProgressMessage
from casingfem.cli.read_study import any_study
from casingfem.cli.running import STORES, deliver

if TYPE_CHECKING:
    from casingfem.plot.page import Page
    from contact import NumericsError
    from contact.result import Result


class Part(NamedTuple):
    """The page about one file, facts for the JSON document, and the run of a scene with any error that ended it."""

    page: "Page"
    facts: dict[str, Any]
    result: "Result | None" = None
    broken: "NumericsError | None" = None


def write_report(files: Sequence[Path], as_json: bool, folder: Path) -> None:
    """Write the page, also for a failed or diverged run, which then ends with exit code 3."""
    from casingfem.plot.page import render_pages

    names = [STORES["report"]] if len(files) == 1 else [f"part{k}.{STORES['report']}" for k in range(1, len(files) + 1)]
    stores = {file: folder / name for file, name in zip(files, names, strict=True)}
    parts = {file: scene_part(file, store) if is_scene(file) else study_part(file) for file, store in stores.items()}
    pages = [part.page for part in parts.values()]
    facts = [part.facts for part in parts.values()]
    seconds = sum(one["seconds"] for one in facts)
    of_all = facts[0] if len(facts) == 1 else {"seconds": seconds, "parts": facts}
    document = {"report": str(folder / "report.html"), **of_all}
    html = render_pages(pages[0].title if len(pages) == 1 else ", ".join(file.stem for file in parts), pages)
    deliver(document, f"{seconds:.1f} s", as_json=as_json, out=folder, files={"report.html": html})
    for store in stores.values():
        store.unlink(missing_ok=True)
    for file, part in parts.items():
        if part.result is not None:
            require_solved(f"report {file}", part.result, part.broken)


def study_part(file: Path) -> Part:
    """Compute a study and make its page."""
    study = any_study(file)
    with ProgressMessage(f"report on {file.name}") as working:
        from casingfem.plot.pages.study import study_page

        page = study_page(study, working.say)
    return Part(page, {"seconds": working.seconds, "source": study.source})


def scene_part(file: Path, store: Path) -> Part:
    """Run a scene, which continues from `store`, and make its page."""
    from casingfem.cli.scene_page import page
    from contact import load_scene

    scene = load_scene(file)
    with ProgressMessage(f"report on {file.name}: running") as working:
        result, broken = ran(scene, lambda done: working.say(f"report on {file.name}, run", done), store)
        made = page(scene, result, file, lambda what: working.say(f"report on {file.name}: {what}"))
    return Part(made, {"seconds": working.seconds, "flags": [flag.to_dict() for flag in result.flags]}, result, broken)
