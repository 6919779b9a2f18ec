"""Texts drawn at random for a reader: a seed gives the same ones, all of them from pages, docstrings and messages."""

from reports.tools.drawn import drawn, messages


def test_a_seed_draws_the_same_texts_and_another_seed_others(tmp_path):
    for folder in ("docs", "casingfem", "contact"):
        (tmp_path / folder).mkdir()
    for k in range(60):
        (tmp_path / "docs" / f"{k}.md").write_text(
            f"# Page {k}\n\nA sentence.\n\n```python\ncode\n```\n", encoding="utf-8"
        )
        source = f'"""Module {k}."""\nraise ValueError("found no number {k} in the file, expected one above zero")\n'
        (tmp_path / "contact" / f"m{k}.py").write_text(source, encoding="utf-8")
    once, again, other = (drawn(seed, tmp_path) for seed in (71, 71, 73))
    assert once == again
    assert {kind: len(passages) for kind, passages in once.items()} == {"pages": 20, "docstrings": 40, "messages": 40}
    assert all(set(once[kind]) != set(other[kind]) for kind in once)
    assert {passage.text for passage in once["pages"]} == {"A sentence."}


def test_a_message_is_one_text_with_what_a_run_fills_in(tmp_path):
    (tmp_path / "contact").mkdir()
    source = (
        'def f(x):\n    raise ValueError(f"found {x!r} where the law of contact ends, expected a number above 0")\n'
    )
    (tmp_path / "contact" / "law.py").write_text(source, encoding="utf-8")
    (found,) = messages(tmp_path)
    assert found.place == "contact/law.py:2"
    assert found.text == "found {x} where the law of contact ends, expected a number above 0"
