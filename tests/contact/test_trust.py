"""Why not to trust a run: one table of codes, the same in results, files, rows of sweeps and exit codes."""

import json

import pytest
from click.testing import CliRunner

import contact as ct
from casingfem.cli import main
from tests.probed import numbers_of_document

RODS = """
[scene]
kind = "rods"
t_end = {t_end}
[[rod]]
length = 0.50627
area = 2e-4
E = 71e9
rho = 2770.0
elements = 100
x = -0.50627
velocity = 4.0
[[rod]]
length = 0.80809
area = 1.3e-4
E = 113e9
rho = 4430.0
elements = 160
x = 0.0
fixed = "right"
[scheme]
kind = "newmark"
beta = 0.25
gamma = {gamma}
courant = 0.5
"""
RINGS = RODS.format(t_end=1.5e-3, gamma=0.5)  # 2.24 J at the start; contact and scheme make some 15 J in 3,001 steps


def invoked(tmp_path, text, *words):
    (tmp_path / "scene.toml").write_text(text)
    return CliRunner().invoke(main, [*words[:1], str(tmp_path / "scene.toml"), *words[1:]])


@pytest.mark.slow
def test_energy_that_contact_made_fails_a_run_however_short(tmp_path, held):
    ran = invoked(tmp_path, RINGS, "contact", "--json")
    assert ran.exit_code == 3
    document = json.loads(ran.stdout)
    (flag,) = document["flags"]
    assert (flag["code"], flag["failed"]) == ("energy-grows", True)
    assert document["divergence"]["limit"] == "energy"
    assert document["divergence"]["reached"] > 2.24  # more than the start has; the motion is chaotic, so is the amount
    assert "[energy-grows]" in ran.stderr
    scene = ct.load_scene(tmp_path / "scene.toml")
    with pytest.raises(ct.NumericsError, match=r"contact and scheme added \d") as caught:
        ct.run(scene)
    assert caught.value.result.steps == 3001
    kept = ct.run(scene, on_limit="flag")
    assert [(one.code, one.failed) for one in kept.flags] == [("energy-grows", True)]
    (outcome,) = ct.run_many([scene])
    assert type(outcome) is type(caught.value)
    assert outcome.result.flags == caught.value.result.flags
    again = ct.Result.load(kept.save(tmp_path / "kept.npz"))
    assert [one.to_dict() for one in again.flags] == [one.to_dict() for one in kept.flags]
    held(1e-4, document=numbers_of_document(document))


@pytest.mark.slow
def test_a_scheme_that_rings_less_makes_no_energy(tmp_path):
    ran = invoked(tmp_path, RODS.format(t_end=1.5e-3, gamma=0.5).replace("beta = 0.25", "beta = 0.5").replace(
        "gamma = 0.5", "gamma = 0.55"), "contact", "--json")  # fmt: skip
    assert (ran.exit_code, json.loads(ran.stdout)["flags"]) == (0, [])


@pytest.mark.slow
def test_a_sweep_has_the_codes_of_its_runs(tmp_path):
    text = RINGS + '[sweep]\n[[sweep.vary]]\nkey = "scheme.beta"\nvalues = [0.25, 0.3]\n'
    ran = invoked(tmp_path, text, "sweep", "--json", "--jobs", "1")
    rows = json.loads(ran.stdout)["runs"]
    assert (rows[0]["status"], rows[0]["flags"]) == ("diverged", "energy-grows")
    assert "[energy-grows]" in rows[0]["why"]


@pytest.mark.slow
def test_a_page_states_that_the_numbers_are_no_solution(tmp_path):
    ran = invoked(tmp_path, RINGS, "report", "--out", str(tmp_path / "out"))
    assert ran.exit_code == 3
    assert "Not usable: the numbers are no solution of the model" in (tmp_path / "out/report.html").read_text()


@pytest.mark.slow
@pytest.mark.parametrize(("stiffness", "failed"), [(5e3, False), (50.0, True)])
def test_penetration_is_compared_with_the_length_of_the_rod(stiffness, failed):
    """A bar of 10 m at 10 m/s: 0.1 m are a per cent of it, a metre a tenth."""
    bar = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, x=0.1, velocity=-10.0)
    law = ct.Penalty(stiffness=stiffness)
    result = ct.run([bar, ct.Wall()], law=law, scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55), t_end=0.4, dt=1e-3,
                    on_limit="flag")  # fmt: skip
    share = result.max_penetration[0] / 10.0
    assert 0.01 < share if failed else share < 0.1
    flags = {flag.code: flag.failed for flag in result.flags}
    assert flags.get("penetration", False) is failed


@pytest.mark.slow
@pytest.mark.parametrize(("updates", "failed"), [(1, True), (2000, None)])
def test_updates_that_do_not_settle_are_flagged(updates, failed):
    law = ct.laws.AugmentedLagrangian(stiffness=100.0, updates=updates)
    bar = ct.Rod(length=10.0, area=1.0, E=900.0, rho=1.0, elements=10, x=0.1, velocity=-1.0)
    result = ct.run([bar, ct.Wall()], law=law, scheme=ct.scheme.Newmark(beta=0.5, gamma=0.55), t_end=0.3, dt=0.01,
                    on_limit="flag")  # fmt: skip
    assert {flag.code: flag.failed for flag in result.flags}.get("unconverged") is failed
