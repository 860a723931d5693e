#!/bin/bash
# self_test.sh [BUILD]: proves that compare_builds.sh finds what differs, with commands that only look like Selvage's;
# with BUILD, also with that build and a copy of it in which one file and one picture are spoilt.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scratch=$(mktemp -d "${TMPDIR:-/tmp}/selvage-compare-test-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
unset SELVAGE_SAMPLES SELVAGE_CONFORMANCE
failures=0

# A build whose `selvage` writes what its arguments say, but for the FAULT that is built in.
make_build() { # name fault
    local bin=$scratch/$1/bin
    mkdir -p "$bin"
    cat >"$bin/selvage-assets" <<'STUB'
#!/bin/sh
mkdir -p "$1"
for file in scene.obj scene.ptx scene_faces.ptx; do echo "v $file" >"$1/$file"; done
case FAULT in many) echo "v 1 2 3" >>"$1/scene.obj" ;; esac
STUB
    cat >"$bin/selvage" <<'STUB'
#!/bin/bash
# The part of Selvage that a comparison can see.
fault=FAULT all=$*
case $all in
"render --help")
    echo "  --strategy WORD        how (traverse): clamp|traverse$([ $fault = many ] && echo '|other')"
    exit
    ;;
"sample --help")
    printf '  FILTER is point, box or\n  gaussian.\n'
    exit
    ;;
"--help")
    printf 'Verbs:\n  render    draw\n\n'
    exit
    ;;
esac
out=
for ((i = 1; i <= $#; i++)); do
    case ${!i} in --out | -o) j=$((i + 1)) out=${!j} ;; esac
done
case $1 in
info) printf '{\n  "faces": 4,\n  "channels": 3,\n  "data_type": "uint8",\n}\n' ;;
convert | render | transfer) : "${out:=$3}" ;;
esac
if [ -n "$out" ]; then echo "$all" >"$out"; fi
case $fault:$all in
many:*"small.ptx --compression 12") printf 'x' >>"$out" ;;
many:*"--type uint8"*) echo "a word more" ;;
many:*"--type uint16 --json") echo "a warning more" >&2 ;;
many:*"--type half --json") exit 1 ;;
many:*"--type float --json") kill -SEGV $$ ;;
many:*"b.ptx --border periodic"*) rm "$out" ;;
many:render*"--aniso 1 "*"traverse"*) echo x >>"$out" ;;
sometimes:*"--type float"*) echo "$RANDOM$RANDOM$RANDOM" ;;
sometimes:render*) exit 1 ;;
esac
if [ "$1" = reference ]; then echo "{\"seconds\": $RANDOM.5, \"million_samples_per_second\": $RANDOM}"; fi
exit 0
STUB
    sed -i "s/FAULT/$2/" "$bin"/*
    chmod +x "$bin"/*
}

# Compares two builds, and looks at the exit code and for lines in what is printed.
expect() { # what code pattern OLD NEW [options]
    local what=$1 code=$2 pattern=$3 found=0
    shift 3
    bash "$here/compare_builds.sh" "$@" >"$scratch/printed" 2>&1 || found=$?
    if [ "$found" != "$code" ]; then pattern="exit code $code, not $found"; fi
    printed "$what" "$pattern"
}

printed() { # what pattern
    if grep -Eq -- "$2" "$scratch/printed"; then
        echo "ok: $1"
        return
    fi
    echo "FAILED: $1: nothing like '$2' in:"
    sed 's/^/    /' "$scratch/printed" | head -n 40
    failures=$((failures + 1))
}

faults() {
    local fault options=(--quick --data "$scratch/data")
    mkdir -p "$scratch/data"
    echo "a file of no kind, but long enough to be cut into pieces" >"$scratch/data/one.ptx"
    for fault in none many sometimes; do make_build "$fault" "$fault"; done
    local none=$scratch/none
    expect "what is spoilt is found, and nothing else" 1 '^[0-9]+ compared, 9 differ$' "$none" "$scratch/many" \
        "${options[@]}" --groups convert,pictures,reference
    printed "another scene is found" 'differs: scene.obj'
    printed "a strategy more is found" 'only in one build: other'
    printed "a byte more in one file is found" 'Files old/small.ptx and new/small.ptx differ'
    printed "other output is found" '> a word more'
    printed "other errors are found" '> a warning more'
    printed "another exit code is found" '> exit 1$'
    printed "a crash is found" '> exit 139$'
    printed "a file that is not written is found" 'Only in old: b.ptx'
    printed "another picture is found" 'differs: render demo/scene.ptx traverse, anisotropy 1$'
    printed "what is equal is called so" '^reference +2 compared, 0 differ$'
    expect "pictures that neither can draw are no success" 2 'no command of this group succeeds' "$scratch/sometimes" \
        "$scratch/sometimes" "${options[@]}" --groups convert,pictures
    printed "what changes from run to run is called so" 'differs from itself'
    expect "a folder that is no build is refused" 2 'is no build' "$none" "$scratch/data"
    expect "an unknown group is refused" 2 'no group nonsense' "$none" "$none" "${options[@]}" --groups nonsense
    expect "an unknown option is refused" 2 'unknown option' "$none" "$none" --nonsense
}

# A build that is BUILD but for the last byte of files of halves and of pictures by one strategy.
spoil() { # BUILD
    local build program
    build=$(cd "$1" && pwd)
    mkdir -p "$scratch/spoilt/bin"
    ln -s "$build/lib" "$scratch/spoilt/lib"
    for program in "$build"/bin/*; do ln -s "$program" "$scratch/spoilt/bin/"; done
    rm "$scratch/spoilt/bin/selvage"
    cat >"$scratch/spoilt/bin/selvage" <<STUB
#!/bin/bash
"$build/bin/selvage" "\$@" || exit
case "\$*" in
"convert ../in/data/"*" out.ptx --type half"* | "render ../in/demo/"*"out.exr --aniso 16"*"--strategy discard"*)
    truncate -s -1 out.*
    ;;
esac
STUB
    chmod +x "$scratch/spoilt/bin/selvage"
    expect "a spoilt file and a spoilt picture of a build are found" 1 'Files old/out.ptx and new/out.ptx differ' \
        "$build" "$scratch/spoilt" --quick --groups convert,pictures
    printed "the picture is named" 'differs: render demo/scene.ptx discard, anisotropy 16$'
    printed "and it is the only one" '^pictures .* 1 differ'
}

faults
if [ $# -gt 0 ]; then spoil "$1"; fi
echo "$failures failures"
[ "$failures" = 0 ]
