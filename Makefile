# Two commands do everything on a fresh clone: `make demo` and `make test`. Both set up first.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/installed

.PHONY: demo test explore check bench setup clean

demo: $(STAMP)
	$(BIN)/periph-sim run timing/imu_hil.toml

test: check
	$(BIN)/coverage erase
	$(BIN)/pytest -n auto -m "not long" --cov --cov-report=term:skip-covered
	$(BIN)/pytest -n auto -m long
	$(BIN)/python -m tests.rules.coverage

# Properties with examples of chance, many more of them: for a quiet evening.
explore: $(STAMP)
	$(BIN)/pytest -n auto -m long --hypothesis-profile=explore

check: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache

bench: $(STAMP)
	$(BIN)/python -m tests.bench.speed
	$(BIN)/python -m tests.bench.decode
	$(BIN)/python -m tests.bench.numeric

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	touch $@

clean:
	rm -rf $(VENV) build .coverage* .hypothesis .pytest_cache .mypy_cache .ruff_cache
