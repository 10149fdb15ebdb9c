# `make fly` and `make test` work in a fresh clone with Python 3.11+, pip and make; both can be run again and again.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
PIP    := PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_CONSTRAINT=$(CURDIR)/constraints.txt $(BIN)/python -m pip

.PHONY: help fly test lint validate certify mutants golden recordings bench docs-numbers aircraft clean

help:
	@echo "make fly       install, then fly the scenario 'catapult' with its score and plots"
	@echo "make test      every check and test (ruff, mypy, import-linter, pytest)"
	@echo "make validate  the statistical checks over many seeds, and the long attacks (a quarter of an hour)"
	@echo "make certify   every set of docs/certify.md, whole (two to three hours; goes on where it was ended)"
	@echo "make mutants   how many of 300 small errors the tests see (half an hour)"
	@echo "make golden    fly the short flights whose figures are kept, and keep them anew"
	@echo "make recordings  replay the logs of the folder UAVSIM_RECORDINGS against their right answers"
	@echo "make bench     what a step costs"
	@echo "make docs-numbers  run what the docs show and has not been run, and write their pages (half an hour)"
	@echo "make aircraft  rebuild the aerodynamic tables of aircraft/fw8 and fw25 (installs AeroSandbox)"
	@echo "make clean     remove the environment and caches"

fly: $(VENV)/.fly
	$(BIN)/uavsim fly catapult

test: lint
	$(BIN)/python -m pytest -q -m "not slow" -n auto --dist worksteal

lint: $(VENV)/.dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

validate: $(VENV)/.dev
	$(BIN)/python -m pytest -q -m "slow and not certify" -n 2 --dist loadfile

certify: $(VENV)/.dev
	met=0; \
	$(BIN)/python scripts/certify.py --out output/certify --resume --results docs/results --docs || met=1; \
	$(BIN)/python -m pytest -q -m "slow or certify" --whole -n 2 --dist loadfile || met=1; \
	exit $$met

mutants: $(VENV)/.dev
	$(BIN)/python scripts/mutants.py --out output/mutants.json

golden: $(VENV)/.dev
	$(BIN)/python tests/golden_flights.py

recordings: $(VENV)/.fly
	$(BIN)/python scripts/recordings.py --out output/recordings.md

bench: $(VENV)/.fly
	$(BIN)/uavsim bench

docs-numbers: $(VENV)/.dev
	$(BIN)/python scripts/docs_numbers.py --missing --jobs 2

aircraft: $(VENV)/.dev
	$(PIP) install -q -e '.[aircraft]'
	$(BIN)/python scripts/build_aircraft.py aircraft/fw8
	$(BIN)/python scripts/build_aircraft.py aircraft/fw25

# A stamp is only written after a whole installation, so an interrupted one is simply done again.
$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "uavsim needs Python 3.11 or newer; choose one with: make PYTHON=python3.11 …")'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.fly: pyproject.toml constraints.txt | $(BIN)/python
	$(PIP) install -q -e .
	@touch $@

$(VENV)/.dev: pyproject.toml constraints.txt | $(BIN)/python
	$(PIP) install -q -e '.[dev]'
	@touch $@ $(VENV)/.fly

clean:
	rm -rf $(VENV) .mypy_cache .pytest_cache .ruff_cache .import_linter_cache .hypothesis
