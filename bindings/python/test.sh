#!/bin/sh
# test.sh BUILD WORK [PYTEST ARGUMENTS...]: the wheel, made from the objects of BUILD, installed into an empty environment
# in WORK, and its tests there. Nothing comes from a registry.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
mkdir -p "$2"
work=$(cd "$2" && pwd)
shift 2

rm -rf "$work/venv" "$work/wheel"
/usr/bin/python3 -m venv --system-site-packages --without-pip "$work/venv"  # with Debian's pip
python=$work/venv/bin/python
SOAPFILM_BUILD_DIR=$build "$python" -m pip wheel --quiet --no-index --no-build-isolation --no-deps --wheel-dir \
  "$work/wheel" "$root"
"$python" -m pip install --quiet --no-index --no-deps "$work"/wheel/*.whl
cd "$work"
export SOAPFILM_PROGRAM="$build/bin/soapfilm" PYTHONDONTWRITEBYTECODE=1
"$python" -m pytest -q -p no:cacheprovider "$@" "$root/bindings/python/tests"
