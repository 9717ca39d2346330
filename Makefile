# On a fresh clone, `make demo` runs a case and `make test` runs all checks and tests. Both first install what they
# need: the demo the packages of a user, the tests those of a developer.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
USER := $(VENV)/installed
CORE := $(VENV)/installed-core
DEV := $(VENV)/installed-dev
# --no-compile: Python compiles the few modules that are imported when it imports them.
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile -c constraints.txt
# Passed as --rules=FILE: with a space before it, pytest would collect an existing FILE as a test file.
RULES := build/rules.json

# Without bytecode files, every command that a test starts would compile the package again.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test interpreted core wheel try-core touched coverage explore check bench mutants firmware-mutants setup site clean

# Runs the reference case, and proves a small image for every start of a round. Both run interpreted, so that the user
# sees output soon. Then the core is compiled, which makes the next runs faster.
demo: $(USER)
	$(BIN)/periph-sim run timing/imu_hil.toml
	$(BIN)/periph-sim prove timing/variants/image_register_slave.toml --table
	@$(MAKE) --no-print-directory try-core

# Runs every test once, compiled if there is a C compiler. The check of types uses one CPU, so the core is compiled
# meanwhile.
test: $(DEV)
	@$(MAKE) --no-print-directory -j2 check try-core
	rm -f $(RULES)
	$(BIN)/pytest -n auto --dist worksteal --rules=$(RULES)
	$(BIN)/python -m tests.rules.coverage

# Runs the tests of compiled modules again, interpreted. INTERPRETED: options of pytest; the gate leaves out the tests
# that `make coverage` also runs interpreted.
INTERPRETED ?=
interpreted: $(DEV)
	$(BIN)/python -m tests.interpreted -n auto --dist worksteal $(INTERPRETED)

# Runs the tests that import files changed since a commit, the most direct ones first: make touched SINCE=HEAD
SINCE ?= main
touched: $(DEV)
	$(BIN)/python -m tests.touched $(SINCE) -n auto

# Measures the lines and branches that short tests reach; fails below 90 %. It runs interpreted, because lines of
# compiled code cannot be measured. slipcover instruments branches when it loads a module, which fails with a warning if
# pytest rewrites its asserts.
COUNTED := build/coverage.json
coverage: export PERIPH_SIM_FORM := interpreted
coverage: export PYTHONWARNINGS := ignore:Unable to activate pytest branch coverage
coverage: $(DEV)
	mkdir -p $(dir $(COUNTED))
	$(BIN)/python -m slipcover --json --out $(COUNTED) -m pytest -n auto --dist worksteal --assert=plain -m "not long and not uncounted"
	$(BIN)/python -m slipcover --merge $(COUNTED) --out $(COUNTED) --fail-under 90

# Runs the property tests with many more random examples, which takes long.
explore: $(DEV)
	$(BIN)/pytest -n auto -m long --hypothesis-profile=explore

# Lists one-line mutants of the committed tree that no test kills:
# make mutants COUNT=40 SEEDS="1 drawn" ROOMS="chips insight"
COUNT ?= 300
SEEDS ?= 1 2 3 drawn
ROOMS ?= chips processor measures decoders insight
mutants: $(DEV)
	$(BIN)/python -m tests.mutants --count $(COUNT) $(SEEDS:%=--seed %) $(ROOMS:%=--room %)

# Changes every statement of both emulators; results.md of tests/firmware_mutants names the budget that detects each
# mutant. The shipped budgets detect 80 % of random mutants that change bytes, their order or a deadline in any of 200
# phases.
firmware-mutants: $(DEV)
	$(BIN)/python -m tests.firmware_mutants
	$(BIN)/python -m tests.firmware_mutants.real

check: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

# Writes all benchmarks to build/bench/bench.json and bench.svg. The comparison with other simulators needs the extra
# bench (pip install -e '.[bench]') and iverilog. python -m tests.bench.speed_table build/bench/bench.json then writes
# the table of docs/fidelity.md. Runs of up to a simulated hour: make bench LONG=--long
LONG ?=
bench: $(DEV)
	@$(MAKE) --no-print-directory try-core
	$(BIN)/python -m tests.bench $(LONG)

# Compiles the core next to its sources. Without a C compiler, or after a change of the sources, the sources are used.
# JOBS=1: one module at a time.
# HARD=1: an additional build for tests, which stops at the first fault; `python -m tests.hard` runs tests with it.
# CASES="timing/imu_hil.toml": a build that gcc optimizes for the execution of these cases; it takes twice as long.
HARD ?=
CASES ?=
core: $(CORE)
	$(BIN)/python -m periph_sim.form.$(if $(CASES),profiled $(CASES),build $(if $(HARD),--hard))

# Compiles the core if possible. Without a C compiler, or without network to install Cython, make continues.
try-core:
	@if command -v $(firstword $(CC)) >/dev/null; then $(MAKE) --no-print-directory core || echo "runs stay interpreted"; \
	else echo "there is no C compiler $(firstword $(CC)), so runs stay interpreted; \`make core\` compiles once there is one"; fi

# Builds two wheels: one for any Python, and one for this Python and platform with the compiled core.
wheel: $(CORE)
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .
	HATCH_BUILD_HOOKS_ENABLE=1 $(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .
	ls dist

# Builds the documentation as a site with search in build/site.
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
