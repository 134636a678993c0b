# The commands of this project; `make help` lists them.
SHELL := /bin/bash
BIN := .venv/bin
RANKS ?= $(shell n=$$(nproc); [ $$n -gt 2 ] && echo 2 || echo $$n)
# the wheels have an MPI of their own
MPIRUN = $(or $(wildcard $(BIN)/mpirun),mpirun) -n $(RANKS)

# mpirun refuses root and more ranks than cores unless told; containers often have both.
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
export OMPI_MCA_rmaps_base_oversubscribe := 1
# the same for Open MPI 5
export PRTE_MCA_rmaps_default_mapping_policy := :oversubscribe
# containers often forbid it; then each process compiles all modules of Python again
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: help setup tools demo sweep test browser notebook verify hard survive tables speed accuracy \
    calibration knowledge growth times validate peers robots check format docs pictures schema clean \
    test-fast test-long test-wheel test-debian13 test-image platforms paper

help: ## list the commands
	@sed -n 's/^\([a-z0-9-]*\):[^#]*## \(.*\)/  make \1	\2/p' $(MAKEFILE_LIST) | expand -t 20

setup: ## install what is needed; under a second when nothing is to do
	@./setup.sh

tools: setup ## install what docs, notebook and the test in a browser need as well
	@./setup.sh tools

demo: setup ## bend the baseline actuator: curves, pictures and fields in runs/free_bending
	$(MPIRUN) $(BIN)/fiberbend run cases/free_bending.yaml --out runs/free_bending --overwrite

SWEEP ?= cases/sweeps/radius_length_wall.yaml
sweep: setup ## solve SWEEP=cases/sweeps/….yaml, resumable; make -j2 sweep or JOBS=2: in parallel
	$(BIN)/fiberbend sweep $(SWEEP) -j $(or $(JOBS),$(patsubst -j%,%,$(filter -j%,$(MAKEFLAGS))),1)

test: tools ## run the tests but the long ones, two at a time; ten minutes
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(RANKS) --dist worksteal

test-long: tools ## the tests marked long: kills, examples, whole pages, wide designs
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(RANKS) --dist worksteal -m 'long and not verify and not hard'

test-fast: setup ## the tests of tests/fast.txt: section, cell, bodies, two ranks, bad input, resume
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(RANKS) --dist worksteal -m 'not verify and not hard' $$(< tests/fast.txt)

test-wheel: ## test-fast with dolfinx as wheels from PyPI, in build/wheel
	bench/stacks/on.sh wheel test-fast

test-debian13: ## test-fast on a Debian 13 of its own, in build/debian13; needs root
	bench/stacks/on.sh debian13 test-fast

test-image: ## follow Dockerfile without Docker in a Debian 13, and run what it makes offline; needs root
	bench/stacks/on.sh image

browser: tools ## open reports in headless Chromium and use them; part of make test
	$(BIN)/python -m pytest tests/report/test_browser.py

notebook: tools ## run the notebook in examples/; part of make test-long
	$(BIN)/jupyter-execute examples/first_actuator.ipynb

verify: setup ## run the slow convergence ladders against exact solutions
	$(BIN)/python -m pytest -m verify

hard: setup ## run the hard cases in every model and write docs/stability.md
	OPENBLAS_NUM_THREADS=1 $(BIN)/python bench/hard.py
	$(BIN)/python -m pytest -m hard tests/bench/test_families.py tests/run

survive: setup ## kill runs at random moments and go on; damaged cases; writes docs/stability.md
	$(BIN)/python bench/survive_kill.py
	$(BIN)/python bench/survive_fuzz.py

tables: setup ## make the accuracy tables in docs/ again; half an hour
	$(MPIRUN) $(BIN)/python bench/tables.py
	OPENBLAS_NUM_THREADS=1 $(BIN)/python bench/contact.py

knowledge: setup ## solve the ladders from which an accuracy chooses; an hour
	OPENBLAS_NUM_THREADS=1 $(BIN)/python bench/knowledge.py

calibration: setup ## calibrated windings beside every turn by itself; an hour on an idle machine
	OPENBLAS_NUM_THREADS=1 $(BIN)/python bench/calibration.py

# further the sheath wrinkles under the post where a mesh resolves it
BLOCKED := cases/blocked_tip.yaml --set 'effects.0.pressure.to=100 kPa' \
    --set 'output.at_pressures=[25 kPa, 50 kPa, 75 kPa, 100 kPa]' --within 2min

accuracy: setup ## what accuracy costs in time: two ladders, prices; an idle machine, half an hour; resumable
	@$(BIN)/fiberbend accuracy cases/free_bending.yaml --dry-run | tail -1
	@$(BIN)/fiberbend accuracy $(BLOCKED) --dry-run | tail -1
	# code 2: a rung has failed, and the page names it
	OPENBLAS_NUM_THREADS=1 $(BIN)/fiberbend accuracy cases/free_bending.yaml $(LADDER) || [ $$? -eq 2 ]
	OPENBLAS_NUM_THREADS=1 $(BIN)/fiberbend accuracy $(BLOCKED) $(LADDER) || [ $$? -eq 2 ]
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m bench.prices
	$(BIN)/python -m bench.accuracy

platforms: setup ## answers and times of this stack, or ON=wheel, debian12, debian13; docs/platforms.md
	$(if $(ON),bench/stacks/on.sh $(ON) platforms,$(BIN)/python -m bench.platforms)
	$(if $(ON),$(BIN)/python -m bench.platforms --page)

speed: setup ## measure what an answer costs in each model; four minutes on an idle machine
	OPENBLAS_NUM_THREADS=1 $(BIN)/python bench/speed.py

growth: setup ## time and memory on finer and finer bodies, one and two ranks; ten minutes; resumable
	$(BIN)/python -m bench.growth

times: setup ## fit the times and memory of `fiberbend plan` to runs; an idle machine, three minutes
	$(BIN)/python -m bench.plan_times $(TIMES)

validate: setup ## figures beside those that no one here wrote, docs/validation.md; a few minutes
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m bench.validate

paper: setup ## figures and tables of the paper with verdicts, runs/paper/index.html; FULL=1: bodies too; ASSUME=1: what it leaves open, anew
	$(if $(ASSUME),OPENBLAS_NUM_THREADS=1 $(BIN)/python -m bench.paper.assumed)
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m bench.paper $(if $(FULL),--full)

robots: setup ## PyElastica and MuJoCo in build/, and the tests of what they make of an export
	bench/peers/robots.sh
	$(BIN)/python -m pytest tests/export

peers: setup ## bend the same actuator in CalculiX, felupe and plain dolfinx; half an hour
	bench/peers/setup.sh
	$(BIN)/python -m bench.peers.run

check: tools ## lint, format, types, the order of the folders and dead code
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/vulture

format: setup ## put the code in its format
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: tools ## write generated pages and the drawing, build the site docs/_build/html
	$(BIN)/python bench/columns.py
	$(BIN)/python -m bench.pages
	$(BIN)/python bench/actuator_drawing.py
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs docs/_build/html
	@echo "docs: open docs/_build/html/index.html"

pictures: tools ## do what the tutorial says and take its pictures; a minute
	$(BIN)/python -m bench.tutorial_pictures

schema: setup ## rewrite the JSON schema that editors use
	$(BIN)/fiberbend schema > cases/case.schema.json

clean: ## remove .venv, caches and runs
	rm -rf .venv runs build docs/_build docs/_generated *.egg-info .pytest_cache .mypy_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
