"""Options of commands: what they are where they are left out, the last value they take, and the next."""

import click
import pytest

from casingfem.cli import main

# command, option -> its default, and pairs of a value that is taken and one that is not
OPTIONS = {
    ("modes", "sigma"): (1e-4, [(1e-12, 0.0), (0.1, 0.1001)]),
    ("campbell", "to_hz"): (None, [(1e-9, 0.0)]),
    ("campbell", "steps"): (16, [(2, 1), (500, 501)]),
    ("campbell", "count"): (6, [(1, 0), (100, 101)]),
    ("campbell", "orders"): (8, [(1, 0), (100, 101)]),
    ("identify", "order"): (None, [(2, 1), (200, 201)]),
    ("identify", "n_max"): (None, [(0, -1), (200, 201)]),
    ("correlate", "reach"): (0.2, [(1e-9, 0.0), (1.0, 1.001)]),
    ("correlate", "mass"): ("SEREP", [("Guyan", "lumped")]),
    ("locate", "among"): ("bolts", [("mass", "screws")]),
    ("locate", "most"): (4, [(1, 0), (12, 13)]),
    ("locate", "model_error"): (0.0, [(0.0, -1e-9), (0.5, 0.501)]),
    ("mistune", "draws"): (200, [(1, 0), (1_000_000, 1_000_001)]),
    ("mistune", "processes"): (None, [(1, 0), (256, 257)]),
    ("chance", "processes"): (None, [(1, 0), (256, 257)]),
    ("sweep", "jobs"): (None, [(1, 0), (1024, 1025)]),
    ("import", "count"): (20, [(1, 0)]),
    ("import", "zeta"): (0.0, [(0.0, -1e-9), (0.999, 1.0)]),
    ("import", "units"): ("m-kg-s", []),
    ("export", "form"): ("mtx", [("op4", "csv"), ("pch", "bdf")]),
    ("update", "posterior"): (None, [("emcee", "nuts")]),
}


def option(command, name):
    return next(param for param in main.commands[command].params if param.name == name)


def left_out(command, name):
    """What a command is given for an option that nobody has named."""
    return main.commands[command].make_context(command, ["file"], resilient_parsing=True).params[name]


@pytest.mark.parametrize(("command", "name"), OPTIONS)
def test_an_option_has_its_default_and_its_ends(command, name):
    default, ends = OPTIONS[command, name]
    found = option(command, name)
    assert left_out(command, name) == default
    for taken, refused in ends:
        assert found.type.convert(taken, found, None) == taken
        with pytest.raises(click.BadParameter):
            found.type.convert(refused, found, None)


def test_every_command_but_watch_prints_json_and_writes_to_a_folder():
    for name, command in main.commands.items():
        flags = {param.name: param.is_flag for param in command.params if isinstance(param, click.Option)}
        assert name == "watch" or flags["as_json"], name
        assert name in ("watch", "recover", "compile") or flags["out"] is False, name


@pytest.mark.parametrize(
    ("command", "name"),
    [("modes", "vtu"), ("modes", "uff"), ("rub", "vtu"), ("update", "left_out"), ("identify", "open_part")],
)
def test_what_needs_no_value_is_off_by_default(command, name):
    found = option(command, name)
    assert (found.is_flag, left_out(command, name)) == (True, False)


@pytest.mark.parametrize(
    ("command", "needed"), [("schema", False), ("example", False), ("explain", False), ("new", True), ("import", True)]
)
def test_names_that_are_left_out_mean_all(command, needed):
    (argument,) = (param for param in main.commands[command].params if isinstance(param, click.Argument))
    assert argument.required is needed


@pytest.mark.parametrize("value", ["0", "1,0", "a", "1,,2", "-1", "1.0", ""])
def test_numbers_of_modes_are_whole_and_above_0(value):
    found = option("modes", "shown")
    with pytest.raises(click.BadParameter, match=f"found '{value}', expected mode numbers such as 1,2,5"):
        found.callback(click.Context(main.commands["modes"]), found, value)


def test_numbers_of_modes_keep_their_order_and_come_once():
    found = option("modes", "shown")
    context = click.Context(main.commands["modes"])
    assert found.callback(context, found, " 5, 2,5 ,1") == (5, 2, 1)
    assert found.callback(context, found, None) is None
