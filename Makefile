# Everything a fresh machine needs is Python 3.11 or newer, pip and make.

PYTHON ?= python3
BIN := .venv/bin
SHELL := /bin/sh

.PHONY: help demo lab docs test check bench trade clean

help:
	@echo "make demo    install, run the silo with both wings, write out/silo.nc and out/silo.png"
	@echo "make lab     install, open a page in the browser on which the density moves"
	@echo "make docs    install, run the tutorials, build the documentation into out/docs, which needs no network to be read"
	@echo "make test    install, lint, type-check, run all tests"
	@echo "make bench   install, measure speed and memory against the targets, write out/benchmarks.json"
	@echo "make trade   install, measure speed against accuracy on the five scenes, rewrite docs/trade.md (minutes)"
	@echo "make clean   remove the environment and everything that was made"

.venv/installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "kinsim needs Python 3.11 or newer; name one with: make PYTHON=python3.11")'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	@touch $@

demo: .venv/installed
	@mkdir -p out
	$(BIN)/kinsim run silo --out out/silo.nc --plot out/silo.png
	$(BIN)/kinsim compare silo

lab: .venv/installed
	$(BIN)/kinsim lab

.venv/docs: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	@touch $@

docs: .venv/docs
	$(BIN)/sphinx-build --fresh-env --fail-on-warning --keep-going --nitpicky --jobs 2 \
		--doctree-dir out/docs-trees --builder html docs out/docs
	$(BIN)/python .ci/offline.py out/docs
	@echo "open out/docs/index.html"

check: .venv/installed
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

test: check
	$(BIN)/pytest --quiet --numprocesses 2 --dist worksteal

bench: .venv/installed
	$(BIN)/python benchmarks/run.py

trade: .venv/installed
	$(BIN)/python validation/trade.py --full
	$(BIN)/python validation/trade_prediction.py --full
	$(BIN)/python .ci/tables.py out/validation docs/trade.md

clean:
	rm -rf .venv out docs/reference/made build *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
