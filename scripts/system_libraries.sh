#!/bin/sh
# Check that gmsh and VTK find the system libraries they need; install them where this user may.
# usage: system_libraries.sh PYTHON
set -u
python=$1

missing() {
    "$python" - <<'PY'
import ctypes, sys
from meshes.errors import MesherUnavailableError
from meshes.gmsh_meshing import SYSTEM_PACKAGES, load_gmsh
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

packages=$(missing) || exit 1
[ -n "$packages" ] || exit 0

if command -v apt-get >/dev/null 2>&1; then
    if [ "$(id -u)" = 0 ]; then
        as_root=""
    elif sudo -n true 2>/dev/null; then
        as_root="sudo"
    else
        as_root="none"
    fi
    if [ "$as_root" != none ]; then
        echo "Installing system libraries: $packages"
        $as_root apt-get update -qq # fails for any broken source, so the installation is tried all the same
        $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages >/dev/null
        packages=$(missing) || exit 1
        [ -n "$packages" ] || exit 0
    fi
fi
echo "gmsh or VTK lacks system libraries. On Debian or Ubuntu install them with"
echo "    sudo apt-get install $packages"
exit 2
