# Two commands do everything on a fresh clone: `make demo` and `make test`. Both set up first: the demo what a user needs,
# the tests what a developer needs.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
USER := $(VENV)/installed
CORE := $(VENV)/installed-core
DEV := $(VENV)/installed-dev
# Not compiled: Python does that as it imports, with the little of it that is imported.
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -c constraints.txt
# Passed as --rules=FILE: pytest takes an existing file behind a space for the tests to collect.
RULES := build/rules.json

# Without compiled files every command that a test starts would compile the package anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test interpreted core wheel try-core touched coverage explore check bench mutants firmware-mutants setup site clean

# First its table, as the sources run; then the core is compiled, so that the next run is quicker.
demo: $(USER)
	$(BIN)/periph-sim run timing/imu_hil.toml
	@$(MAKE) --no-print-directory try-core

# Every test once, compiled where there is a C compiler. The types are checked on one core, so the others compile meanwhile.
test: $(DEV)
	@$(MAKE) --no-print-directory -j2 check try-core
	rm -f $(RULES)
	$(BIN)/pytest -n auto --dist worksteal --rules=$(RULES)
	$(BIN)/python -m tests.rules.coverage

# The tests of what is compiled once more, interpreted. INTERPRETED: options of pytest; the gate leaves out what
# `make coverage` runs interpreted, too.
INTERPRETED ?=
interpreted: $(DEV)
	$(BIN)/python -m tests.interpreted -n auto --dist worksteal $(INTERPRETED)

# The tests that import what differs from a commit, the nearest first: make touched SINCE=HEAD
SINCE ?= main
touched: $(DEV)
	$(BIN)/python -m tests.touched $(SINCE) -n auto

# Which lines and branches no short test reaches; fails below 90 %. Interpreted: of compiled code no lines are seen.
# slipcover counts branches as it loads a module, where pytest does not rewrite the asserts of it; else it warns.
COUNTED := build/coverage.json
coverage: export PERIPH_SIM_FORM := interpreted
coverage: export PYTHONWARNINGS := ignore:Unable to activate pytest branch coverage
coverage: $(DEV)
	mkdir -p $(dir $(COUNTED))
	$(BIN)/python -m slipcover --json --out $(COUNTED) -m pytest -n auto --dist worksteal --assert=plain -m "not long and not uncounted"
	$(BIN)/python -m slipcover --merge $(COUNTED) --out $(COUNTED) --fail-under 90

# Properties with examples of chance, many more of them: for a quiet evening.
explore: $(DEV)
	$(BIN)/pytest -n auto -m long --hypothesis-profile=explore

# One-line mutants of the committed tree that no test kills: make mutants COUNT=40 SEEDS="1 drawn" ROOMS="chips insight"
COUNT ?= 300
SEEDS ?= 1 2 3 drawn
ROOMS ?= chips processor measures decoders insight
mutants: $(DEV)
	$(BIN)/python -m tests.mutants --count $(COUNT) $(SEEDS:%=--seed %) $(ROOMS:%=--room %)

# Every statement of both emulators changed: results.md of tests/firmware_mutants names the budget that catches each. Of mutants that
# are drawn, and that change bytes, their order or a deadline in any of 200 phases, the shipped budgets detect 80 %.
firmware-mutants: $(DEV)
	$(BIN)/python -m tests.firmware_mutants
	$(BIN)/python -m tests.firmware_mutants.real

check: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

# All parts into build/bench/bench.json and bench.svg. Others beside it: pip install -e '.[bench]', and iverilog.
# Then python -m tests.bench.speed_table build/bench/bench.json writes the table of docs/fidelity.md. Growth to an hour: make bench LONG=--long
LONG ?=
bench: $(DEV)
	@$(MAKE) --no-print-directory try-core
	$(BIN)/python -m tests.bench $(LONG)

# Compiles the core beside its sources; without a C compiler, or after a change of them, the sources run. JOBS=1: one at a time.
# HARD=1: a build for tests that stops at the first fault, beside the usual one; `python -m tests.hard` runs tests with it.
# CASES="timing/imu_hil.toml": a build that gcc optimizes for what these cases execute; it takes twice as long.
HARD ?=
CASES ?=
core: $(CORE)
	$(BIN)/python -m periph_sim.form.$(if $(CASES),profiled $(CASES),build $(if $(HARD),--hard))

# The same, where it can be: without a C compiler, or the network for Cython, all else goes on.
try-core:
	@if command -v $(firstword $(CC)) >/dev/null; then $(MAKE) --no-print-directory core || echo "runs stay interpreted"; \
	else echo "there is no C compiler $(firstword $(CC)), so runs stay interpreted; \`make core\` compiles once there is one"; fi

# Two wheels: one for any Python, and one for this Python and platform that carries the compiled core.
wheel: $(CORE)
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .
	HATCH_BUILD_HOOKS_ENABLE=1 $(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .
	ls dist

# The pages as a site with search, in build/site.
site: $(DEV)
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build

setup: $(DEV)

$(USER): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(PIP) -e .
	touch $@

$(CORE): pyproject.toml constraints.txt | $(USER)
	$(PIP) -e '.[core]'
	touch $@

$(DEV): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(PIP) -e '.[dev]'
	touch $(USER) $(CORE) $@

clean:
	rm -rf $(VENV) build dist periph_sim/compiled .coverage .hypothesis .pytest_cache .mypy_cache .ruff_cache
