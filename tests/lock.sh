#!/usr/bin/env bash
# Writes both lock files of Python anew from pyproject.toml: every platform, every hash, no addresses.
set -euo pipefail
cd "$(dirname "$0")/.."
compile() { uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header --python-version 3.11 --upgrade pyproject.toml "$@"; }
compile --group build -o requirements.lock
compile --group dev -o requirements-dev.lock
