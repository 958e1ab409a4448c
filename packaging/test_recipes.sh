#!/bin/sh
# test_recipes.sh [docker|vcpkg|conda ...]: builds and tries each recipe whose tool is here, by default all three, and
# names those that could not be tried.
set -eu
cd "$(dirname "$0")/.."
failed=

skip() { echo "== $1: not tried, $2"; }
try() {
  echo "== $1"
  shift
  "$@" || failed="$failed $1"
}

docker_recipe() {
  docker build -f packaging/docker/Dockerfile -t soapfilm . &&
    docker run --rm soapfilm --version &&
    docker run --rm --entrypoint sh soapfilm -c \
      'soapfilm -q scan sphere -o s && soapfilm reconstruct s/scans.conf --strict && test -s scans.mesh.ply'
}

vcpkg_recipe() {
  vcpkg install 'soapfilm[tools]' --overlay-ports=packaging/vcpkg/ports --classic
}

conda_recipe() {
  conda build packaging/conda -c conda-forge
}

for recipe in ${*:-docker vcpkg conda}; do
  case $recipe in
    docker)
      if docker info >/dev/null 2>&1; then try docker docker_recipe; else skip docker "no docker daemon"; fi ;;
    vcpkg)
      if command -v vcpkg >/dev/null; then try vcpkg vcpkg_recipe; else skip vcpkg "no vcpkg"; fi ;;
    conda)
      if command -v conda >/dev/null; then try conda conda_recipe; else skip conda "no conda"; fi ;;
    *) echo "test_recipes.sh: '$recipe', must be docker, vcpkg or conda" >&2; exit 2 ;;
  esac
done
[ -z "$failed" ] || { echo "failed:$failed" >&2; exit 1; }
