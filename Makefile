# Everything runs in .venv, which `make install` makes. `make` alone says what there is.

.DEFAULT_GOAL := help
SHELL := /bin/bash
.SHELLFLAGS := -e -o pipefail -c

VENV := .venv/bin/python

# What is installed for what: a larger set includes the smaller ones, and leaves their stamps too.
DEMO := .venv/installed-for-demo
TEST := .venv/installed-for-test
ALL := .venv/installed

# A sourced ROS must not mix with the ROS wheels in .venv, nor another environment's wheels: the
# guard below would keep those in .venv from finding their libraries.
unexport AMENT_PREFIX_PATH LD_LIBRARY_PATH PYTHONHOME PYTHONPATH RMW_IMPLEMENTATION
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE

# Tests start some two hundred processes; each would compile all sources again, for .2 s.
unexport PYTHONDONTWRITEBYTECODE

# A clone that was moved or copied has a .venv that still points at the old place.
ifneq ($(shell cat $(DEMO) 2>/dev/null),$(CURDIR))
$(shell rm -f $(DEMO) $(TEST) $(ALL))
endif

.PHONY: help
help:
	@echo 'make install               make .venv with everything: ROS 2, test and check tools'
	@echo 'make demo                  plan with real ROS nodes and draw demo.png'
	@echo 'make demo MAP=FILE.yaml    the same on a map of your own'
	@echo 'make demo KEEP=1           leave the nodes running, to try calls by hand'
	@echo 'make test                  run the tests (ARGS="-k name -x" goes to pytest)'
	@echo 'make compiled              sweeps, and as machine code what else is tested interpreted'
	@echo 'make digests               whether interpreted kernels and machine code agree to the bit'
	@echo 'make soak                  the nodes under load and faults, for a quarter of an hour'
	@echo 'make check                 format, lint, types, spelling, the site, then the tests'
	@echo 'make bench                 side by side with OMPL, grid search and hopsy, an hour'
	@echo 'make bench QUICK=1         the same in some minutes, for a look'
	@echo 'make docs                  the site, in docs/_build/html'
	@echo 'make figures               the experiments of docs/ again, half an hour'
	@echo 'make figures RUNS=2        a look at them, in experiments/'
	@echo 'make format                format the sources'
	@echo 'make clean                 remove .venv and all that was built'
	@echo
	@echo 'Each works on a fresh clone and installs what it needs into .venv.'
	@echo 'PYTHON=... names the Python for it (3.11 to 3.13).'

.PHONY: install
install: $(ALL)

$(DEMO): EXTRAS := ros,plot
$(DEMO): STAMPS := $(DEMO)
$(TEST): EXTRAS := ros,plot,experiments,cluster,watch,test
$(TEST): STAMPS := $(DEMO) $(TEST)
$(ALL): EXTRAS := ros,plot,experiments,cluster,watch,test,check,docs
$(ALL): STAMPS := $(DEMO) $(TEST) $(ALL)

SUITABLE := import ensurepip, sys, venv; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))

$(DEMO) $(TEST) $(ALL): setup.py
	@for python in $(if $(PYTHON),'$(PYTHON)',python3.12 python3.11 python3.13 python3 \
	               /usr/bin/python3); do \
	  if "$$python" -c '$(SUITABLE)' >/dev/null 2>&1; then found=$$python; break; fi; \
	done; \
	if [ -z "$$found" ]; then \
	  echo 'No Python 3.11, 3.12 or 3.13 with venv and pip was found$(if $(PYTHON), at $(PYTHON)).'; \
	  echo 'On Ubuntu or Debian: sudo apt install python3-venv'; \
	  echo 'Or name one: make install PYTHON=/path/to/python3.12'; \
	  exit 1; \
	fi >&2; \
	if ! grep -qsF '$(CURDIR)/.venv' .venv/bin/activate || \
	   ! $(VENV) -m pip --version >/dev/null 2>&1; then \
	  echo "Making .venv with $$("$$found" --version) ..."; \
	  "$$found" -m venv --clear .venv; \
	fi
	@echo 'Installing $(EXTRAS) into .venv, about a minute; .venv/install.log has the details.'
	@PYTHONUNBUFFERED=1 $(VENV) -m pip install --disable-pip-version-check --no-compile \
	  --editable '.[$(EXTRAS)]' 2>&1 | tee .venv/install.log | \
	while read -r line; do case "$$line" in \
	  Collecting*|Processing*) printf '.' ;; \
	  'Installing collected'*) printf '\nUnpacking, half a minute more ...\n' ;; \
	  ERROR*|error*) printf '\n%s\n' "$$line" ;; \
	esac; done
# All but the libraries' own tests, which are a third of them: it takes half of pip's time.
	@$(VENV) -m compileall -q -j 0 -x '/tests?/' .venv/lib > .venv/compile.log 2>&1 || true
	@for stamp in $(STAMPS); do printf '%s' '$(CURDIR)' > $$stamp; done
	@echo 'Installed. Try make demo, or: source .venv/bin/activate'

.PHONY: demo
demo: $(DEMO)
	$(VENV) -m hnr_planner demo $(if $(MAP),--map '$(MAP)') $(if $(KEEP),--keep)

# A worker for each core, which takes whole files: the tests of a file share a node, in their order.
PARALLEL := --numprocesses logical --maxprocesses 4 --dist loadfile --no-loadscope-reorder

.PHONY: test
test: $(TEST)
	$(VENV) -m pytest $(PARALLEL) -m 'not sweep' $(ARGS)

# What makes tests quick is left out here: running the kernels of a few calls interpreted, and
# leaving out sweeps.
.PHONY: compiled
compiled: $(TEST)
	HNR_COMPILE_ALL=1 $(VENV) -m pytest $(PARALLEL) -m 'interpreted or sweep' $(ARGS)

# BEFORE=FILE compares with the digests that another version wrote.
.PHONY: digests
digests: $(TEST)
	$(VENV) -m test.digests $(if $(BEFORE),--before '$(BEFORE)') $(ARGS)

.PHONY: soak
soak: $(TEST)
	HNR_SOAK=1 $(VENV) -m pytest test/ros/soak $(ARGS)

.PHONY: check
check: lint
	@$(MAKE) --no-print-directory docs
	@$(MAKE) --no-print-directory test

# From a copy in which the links to folders beside docs/ are files: Sphinx follows links to their
# targets, and links between the pages would break.
.PHONY: docs
docs: $(ALL)
	rm -rf docs/_build/source
	mkdir -p docs/_build/source
	tar -C docs --exclude=./_build --exclude=./hnr_planner --dereference -c . | tar -C docs/_build/source -x
	$(VENV) -m sphinx -q -W --keep-going docs/_build/source docs/_build/html
	@echo 'The site begins at docs/_build/html/index.html.'

.PHONY: lint
lint: $(ALL)
	$(VENV) -m ruff format --check .
	$(VENV) -m ruff check .
	$(VENV) -m flake8 .
	$(VENV) -m pydocstyle benchmarks hnr_planner launch test setup.py
	$(VENV) -m mypy
	$(VENV) -m codespell_lib .

# A competitor that has no wheel for this machine is missed, not fatal: the benchmark says so.
.PHONY: bench
bench: $(TEST)
	@for competitor in 'ompl>=2.0' 'nano-astar>=0.1' 'hopsy>=1.7'; do \
	  $(VENV) -m pip install --disable-pip-version-check --quiet "$$competitor" || true; \
	done
	$(VENV) -m benchmarks $(if $(QUICK),--quick)

# The tables of the pages in docs/ follow; what the pages say of them is for people to write.
.PHONY: figures
figures: $(TEST)
ifdef RUNS
	$(VENV) -m hnr_planner experiment --runs $(RUNS)
else
	$(VENV) -m hnr_planner experiment --out docs/figures
	$(VENV) -m hnr_planner.experiments
endif

.PHONY: format
format: $(ALL)
	$(VENV) -m ruff check --fix --exit-zero --quiet .
	$(VENV) -m ruff format .

.PHONY: clean
clean:
	rm -rf .venv build install log *.egg-info .hypothesis .mypy_cache .pytest_cache .ruff_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
