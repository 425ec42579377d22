# Two commands do everything on a fresh machine:
#
#   make demo   runs the main job on the NASA gear noise rig
#   make test   lint, strict types, import arrows, tests but the slow ones
#
# make test-slow runs those, make test-all the tests together, as continuous
# integration does, and make docs builds the documentation site in build/site.
#
# Each makes the virtual environment in .venv and installs into it where that is missing or out of date.

PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
# Byte code is written by what imports it: pip would compile all of the packages, most of which is never imported.
PIP    := $(BIN)/pip --disable-pip-version-check -qq
OUT    ?= results/nasa-gear-noise-rig

# Two cores are the rule; BLAS threads on top of worker processes cost far more than they give.
export OMP_NUM_THREADS ?= 2
export OPENBLAS_NUM_THREADS ?= 2
# Byte code is kept, whatever the surroundings say: the tests start dozens of processes that would compile all anew.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: help demo test test-slow test-all checked-and-compiled lint types unit docs reference validation stiffness-page install install-dev system browser format constraints clean

# One environment: never two installations into it at once, whatever -j says.
.NOTPARALLEL:

demo: install
	$(BIN)/gearwhine run nasa-gear-noise-rig -o $(OUT)

help:
	@echo "make install        packages and compiled kernels, into $(VENV)"
	@echo "make demo           install, then NASA's gear noise rig into $(OUT)"
	@echo "make test           install, then lint, types and tests; make test-slow: the long ones"
	@echo "make test-all       the same with the long ones, in one go: what both share is solved once"
	@echo "make reference      pages of all case keys and command options, in build/reference"
	@echo "make docs           the documentation as a site, in build/site"
	@echo "make validation     docs/validation.md anew, from the tests against published values"
	@echo "make clean          the environment and what these have made"

test: checked-and-compiled unit

# Lint and types take one core for a minute, the browser a download, and the kernels both cores: side by side they take
# less than one after the other.
checked-and-compiled: $(VENV)/.installed-dev
	@$(MAKE) --no-print-directory lint types browser & checks=$$!; \
		$(MAKE) --no-print-directory install-dev; installed=$$?; wait $$checks && exit $$installed

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/.installed-dev
	$(BIN)/mypy

# One thread for each of two worker processes.
PYTEST := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n 2 --dist loadfile

unit: install-dev browser
	$(PYTEST) -m "not slow"

# Whole commands, pages and notebooks, published cases on their full meshes, pages in a browser, chains to the sound.
test-slow: install-dev browser
	$(PYTEST) -m slow

# All in one go: files with slow and fast tests solve what both share once.
test-all: checked-and-compiled
	$(PYTEST)

install: $(VENV)/.installed system $(VENV)/.compiled
install-dev: $(VENV)/.installed-dev system $(VENV)/.compiled

# gmsh and VTK need libraries from the system: this says which, and installs them where it may.
system: | $(VENV)/.installed
	@sh scripts/system_libraries.sh $(BIN)/python

# Chromium for the tests of the report, where it can be had; they are skipped without it.
browser: | $(VENV)/.installed
	@sh scripts/system_libraries.sh $(BIN)/python --browser

# Sources of kernels: what is compiled from others is out of date, and each process of the tests would compile it anew.
KERNELS := $(shell grep -rlE --include='*.py' '\.compiled import|numba\.njit' numerics rotors coupling housing)

# After what it needs of the system, therefore last.
$(VENV)/.compiled: pyproject.toml constraints.txt $(KERNELS) | $(BIN)/python
	@echo "Compiling the kernels (about five minutes of processor time, once) ..."
	@OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python scripts/compile_kernels.py
	@touch $@

$(BIN)/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "Python 3.11 or newer is needed; name one with: make PYTHON=python3.12"; exit 2; }
	$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); exit 2; }

$(VENV)/.installed: pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing (about a minute) ..."
	$(PIP) install --no-compile -c constraints.txt -e .
	@touch $@

$(VENV)/.installed-docs: pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing with the tools of the documentation site ..."
	$(PIP) install --no-compile -c constraints.txt -e .[docs]
	@touch $@

$(VENV)/.installed-dev: pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing with the development tools (some minutes) ..."
	$(PIP) install --no-compile -c constraints.txt -e .[dev]
	@touch $@ $(VENV)/.installed

# The documentation site, from the pages in docs, the docstrings, the schema and the worked examples, which it runs.
# It is read without a network: open build/site/index.html.
docs: $(VENV)/.installed-docs install
	@echo "Building the documentation site; the first time its worked examples run for some minutes ..."
	$(BIN)/sphinx-build -W --keep-going -q -j 2 -b html -c docs . build/site
	@echo "Open $(CURDIR)/build/site/index.html in a browser."

# The validation page and its values, from the tests against published values.
validation: install-dev
	$(BIN)/pytest tests/validation -q --validation-table docs/validation.md

# The pages of the case file and of the commands with all keys and options, in build/reference; make docs has them too.
reference: install
	$(BIN)/python scripts/reference_pages.py

# The tables and the figure of the page of stiffness models.
stiffness-page: install
	$(BIN)/python scripts/gear_stiffness_page.py

format: install-dev
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

# New exact versions: what a fresh environment resolves to today.
constraints:
	rm -rf .venv-constraints
	$(PYTHON) -m venv .venv-constraints
	.venv-constraints/bin/pip --disable-pip-version-check -qq install -e .[dev,docs]
	{ sed -n '/^#/p' constraints.txt; .venv-constraints/bin/pip freeze --exclude-editable; } > constraints.new
	mv constraints.new constraints.txt
	rm -rf .venv-constraints

clean:
	rm -rf $(VENV) .mypy_cache .ruff_cache .pytest_cache .hypothesis build docs/reference docs/gallery
