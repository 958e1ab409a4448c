# shellcheck shell=sh
# Read by test scripts: a fresh Debian 12 to install packages in. Needs root and debootstrap. MIRROR: where Debian comes
# from.

say() { echo "== $*"; }
die() { echo "$(basename "$0"): $*" >&2; exit 1; }

can_make_debian() { [ "$(id -u)" = 0 ] && command -v debootstrap >/dev/null; }

# make_debian WORK: in WORK/root; its logs are in WORK, too.
make_debian() {
  work=$1
  root=$work/root
  rm -rf "$root"
  mirror=${MIRROR:-http://deb.debian.org/debian}
  debootstrap --variant=minbase bookworm "$root" "$mirror" > "$work/debootstrap.log" 2>&1 ||
    { tail -5 "$work/debootstrap.log" >&2; die "debootstrap failed"; }
  mkdir "$root/try"
  inside apt-get update > "$work/apt.log" 2>&1
}

# Runs a command there.
inside() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 DEBIAN_FRONTEND=noninteractive HOME=/root "$@"
}
at_try() { inside sh -c 'cd /try && "$@"' sh "$@"; }

# install_there WHAT PACKAGES: patterns of files are those of the fresh Debian.
install_there() {
  inside sh -c "apt-get install -y --no-install-recommends $2" >> "$work/apt.log" 2>&1 ||
    { tail -20 "$work/apt.log" >&2; die "$1 cannot be installed"; }
}
