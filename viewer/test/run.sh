#!/bin/sh
# run.sh PROGRAM VIEWER_BUILD FOLDER [SCRIPT]: tests the page of `soapfilm view` in headless Chromium, or runs another
# script of this folder. VIEWER_BUILD is the build's viewer/ with its npm packages; pages and pictures go to FOLDER. The
# variable CHROMIUM names another browser than Debian's.
set -eu
here=$(realpath "$(dirname "$0")")
export SOAPFILM_PROGRAM SOAPFILM_MODULES SOAPFILM_OUT
SOAPFILM_PROGRAM=$(realpath "$1")
SOAPFILM_MODULES=$(realpath "$2")/node_modules
mkdir -p "$3"
SOAPFILM_OUT=$(realpath "$3")
# The build leaves out what only tests need.
[ -d "$SOAPFILM_MODULES/gltf-validator" ] || npm ci --loglevel=error --prefix "$2" >/dev/null
exec node "$here/${4:-view.test.mjs}"
