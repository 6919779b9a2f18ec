PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
PIP    := python -m pip install --quiet --disable-pip-version-check --no-compile -c constraints.txt
export MPLBACKEND := Agg
# small factorisations: a second BLAS thread costs more than it gives, several times so on a busy machine
export OPENBLAS_NUM_THREADS ?= 1
# where Python keeps no bytecode, each of some hundred processes compiles what it imports: 1.7 s each
unexport PYTHONDONTWRITEBYTECODE

# one process for each core; tests that share what they compute or compile stay together, in the order of conftest.py
CORES := -n logical

.DEFAULT_GOAL := help
.PHONY: help setup study docs links test variants fast check lint types doctests collect bench campaign mutants clean

help:    ## show what each target does
	@grep -hE '^[a-z]+: .*##|^[a-z]+:  +##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

setup: $(READY) ## make .venv from the project's own files (pinned by constraints.txt)

# --no-compile: of the many modules of the libraries few are ever imported, and those are compiled then;
# the pip that comes with Python reads the list of every release of each library in twice the time that the pinned
# one takes; with the pinned setuptools beside it no second place is made to build in. Setuptools warns of every
# editable install
$(READY): pyproject.toml constraints.txt
	$(PYTHON) -c 'import sys; assert sys.version_info >= (3, 11), "casingfem needs Python 3.11 or newer, found " + sys.version; sys.exit(0)'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/$(PIP) --upgrade pip setuptools
	PYTHONWARNINGS=ignore $(BIN)/$(PIP) --no-build-isolation -e '.[dev]'
	@touch $(READY)

study: $(READY) ## measured frequencies -> updated shells -> reduced bases -> rub -> reports/out/report.html
	$(BIN)/python -m reports.studies.rig

docs: $(VENV)/.docs ## the pages of docs/ as a site, with tutorial and gallery run -> build/docs/index.html
	$(BIN)/python -m sphinx -W --keep-going -q -d build/doctrees docs build/docs
	@echo build/docs/index.html

links: $(VENV)/.docs ## whether the links of the pages that lead to the web still do
	$(BIN)/python -m sphinx -q -b linkcheck -D plot_gallery=0 -d build/links/doctrees docs build/links

# the packages that build the site are an extra of their own
$(VENV)/.docs: $(READY)
	PYTHONWARNINGS=ignore $(BIN)/$(PIP) --no-build-isolation -e '.[docs]'
	@touch $@

test: $(READY) ## every test but those of campaigns
	$(BIN)/python -m pytest $(CORES) -m 'not campaign'

variants: ## every test on other Pythons, versions, processors and orders: a table; an hour (.ci/variants --list)
	.ci/variants

fast: $(READY) ## the tests that take seconds
	$(BIN)/python -m pytest $(CORES) -m 'not slow and not campaign'

check: doctests types lint collect ## lint, format, types, layers, doctests, imports of tests; with -j2 two at a time

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports

# doctests take longest, in one process: that one goes first where both run
types: $(READY)
	nice $(BIN)/mypy --num-workers 2

doctests: $(READY)
	$(BIN)/python -m pytest --doctest-modules casingfem contact

# every test module is found and imported; pytest keeps them compiled, which each worker would else do for itself
collect: $(READY)
	$(BIN)/python -m pytest --collect-only -qqq

bench: $(READY) ## speed tables
	$(BIN)/python -m reports.benchmarks

campaign: $(READY) ## quick reports that no test repeats, then every report in full: hours
	$(BIN)/python -m pytest $(CORES) -m campaign
	$(BIN)/python -m reports.tools.campaign $(NAMES)

mutants: $(READY) ## share of 120 small faults, one at a time, that the tests see; an hour or more, a rerun continues
	$(BIN)/python -m reports.tools.mutants --seed 20261 --count 120 --record

clean:   ## remove what is generated
	rm -rf reports/out build docs/built dist *.egg-info .pytest_cache .mypy_cache .ruff_cache
