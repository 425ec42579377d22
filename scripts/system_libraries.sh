#!/bin/sh
# Check that gmsh and VTK find the system libraries they need; install them where this user may.
# usage: system_libraries.sh PYTHON [--browser]
# With --browser: Chromium alone, for the tests of the report. They are skipped without it, so lacking it is no failure.
set -u
python=$1

missing() {
    "$python" - <<'PY'
import ctypes, sys
from gearwhine.meshes.errors import MesherUnavailableError
from gearwhine.meshes.gmsh_meshing import SYSTEM_PACKAGES, load_gmsh
packages = []
try:
    load_gmsh()
except MesherUnavailableError:
    packages += SYSTEM_PACKAGES
try:
    ctypes.CDLL("libEGL.so.1")
except OSError:
    packages += ["libegl1", "libegl-mesa0", "libgl1"]
print(" ".join(dict.fromkeys(packages)))
PY
}

# Install packages where apt-get is there and this user may.
install() {
    command -v apt-get >/dev/null 2>&1 || return 1
    if [ "$(id -u)" = 0 ]; then
        as_root=""
    elif sudo -n true 2>/dev/null; then
        as_root="sudo"
    else
        return 1
    fi
    echo "Installing system packages: $*"
    $as_root apt-get update -qq # fails for any broken source, so the installation is tried all the same
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=300 "$@" >/dev/null
}

if [ "${2:-}" = --browser ]; then
    for name in chromium chromium-browser google-chrome google-chrome-stable; do
        command -v "$name" >/dev/null 2>&1 && exit 0
    done
    install chromium && command -v chromium >/dev/null 2>&1 ||
        echo "No Chromium: tests of the report in a browser are skipped. On Debian: sudo apt-get install chromium"
    exit 0
fi

packages=$(missing) || exit 1
[ -n "$packages" ] || exit 0
# shellcheck disable=SC2086 # one word a package
install $packages
packages=$(missing) || exit 1
[ -n "$packages" ] || exit 0
echo "gmsh or VTK lacks system libraries. On Debian or Ubuntu install them with"
echo "    sudo apt-get install $packages"
exit 2
