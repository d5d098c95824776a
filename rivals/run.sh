#!/bin/sh
# Runs every comparison whose rival is installed, and names those that are not: run.sh [--quick]
# The exit code is 1 if one of them failed or its answers did not agree.
cd "$(dirname "$0")" || exit 1
case "${1-}" in
    '') passes=5 count=100000 ;;
    --quick) passes=1 count=10000 ;;
    *) echo "usage: run.sh [--quick]" >&2; exit 2 ;;
esac
status=0
missing=''

# step NAME COMMAND..: runs one comparison under its name.
step() {
    printf '\n== %s\n' "$1"
    shift
    "$@" || { status=1; echo "failed: $*"; }
}

# have NAME INSTALL TEST..: whether a rival is here; if not, it is named at the end with how to install it.
have() {
    name=$1 install=$2
    shift 2
    "$@" >/dev/null 2>&1 && return 0
    missing="$missing
  $name: $install"
    return 1
}

compiles_embree() {
    trial=$(mktemp)
    printf '#include <embree3/rtcore.h>\nint main() { rtcReleaseDevice(rtcNewDevice(0)); }\n' \
        | c++ -x c++ - -lembree3 -o "$trial"
    compiled=$?
    rm -f "$trial"
    return $compiled
}

if have 'Rust (cargo)' 'https://rustup.rs' cargo --version; then
    step 'polynomials: kurbo, polycool, roots' cargo run --release --quiet -p rivals-polynomials --bin rivals-polynomials
    step 'torus: kurbo' cargo run --release --quiet -p rivals-torus
    if have 'Embree 3' 'Debian and Ubuntu: apt-get install libembree-dev g++' compiles_embree; then
        step 'acceleration: Embree' acceleration/compare.sh "$count" "$passes"
    fi
    if have 'Python 3' 'Debian and Ubuntu: apt-get install python3' python3 --version; then
        if have 'POV-Ray' 'Debian and Ubuntu: apt-get install povray' povray --version; then
            step 'family: POV-Ray' python3 povray/family.py --passes "$passes"
            step 'nff: POV-Ray' python3 povray/nff.py --passes "$passes"
        fi
        have 'Tachyon' 'Debian and Ubuntu: apt-get install tachyon' command -v tachyon
        step 'scaling: POV-Ray, Tachyon' python3 povray/scaling.py --passes "$passes" --count "$count"
    fi
fi
[ -z "$missing" ] || printf '\nNot run, for want of:%s\n' "$missing"
exit $status
