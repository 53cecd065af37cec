# `make demo` and `make test` need only python3 (3.11 or later) with venv and pip.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin

.PHONY: demo test browser check rebuild parts verification pictures clean

demo: $(VENV)/.report
	@mkdir -p out
	$(BIN)/prs-model modes head_3prs -n 8 --picture out/head_3prs_modes.png
	$(BIN)/prs-model report head_3prs -o out/head_3prs

test: $(VENV)/.test
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist loadfile

# The pages of `report` and `explore` in headless Chromium.
browser: $(VENV)/.test
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -m browser

check: $(VENV)/.dev
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports

# Makes everything anew that is shipped and was computed (about an hour on two cores).
rebuild: parts verification pictures

# Holds the reductions of head_3prs against its complete finite-element model: docs/verification.
verification: $(VENV)/.fem $(VENV)/.mesh $(VENV)/.plot
	$(BIN)/prs-model verify head_3prs --random 20 --curve -o docs/verification
	$(BIN)/prs-model verify head_3prs --bounds -o out/verification_bounds
	$(BIN)/prs-model verify head_3prs --models A --reductions joint-loaded --stiffness 0.5 2 -o out/verification_stiffness

# Rebuilds the meshes and super-elements of head_3prs from its part script (needs Debian's libglu1-mesa and X libraries).
parts: $(VENV)/.fem $(VENV)/.mesh
	$(BIN)/python -m prs_machines.head_3prs.rebuild

# Redraws the pictures of the documentation.
pictures: $(VENV)/.test
	$(BIN)/python docs/pictures/redraw.py

$(VENV)/.pip:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "prs-model needs Python 3.11 or later: make PYTHON=python3.11 ...")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	@touch $@

$(VENV)/.%: $(VENV)/.pip pyproject.toml
	$(BIN)/python -m pip install --quiet --editable '.[$*]'
	@touch $@

.SECONDARY:

clean:
	rm -rf $(VENV) out dist
