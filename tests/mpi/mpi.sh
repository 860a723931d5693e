#!/bin/sh
# mpi.sh SELVAGE: bakes by several processes on this machine: the file is that of one process, to the byte, and a process that
# dies leaves what was there.
set -eu
selvage=$1
folder=$(mktemp -d)
running=
trap '[ -z "$running" ] || kill "$running" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
export OMPI_MCA_btl=self,vader,tcp OMPI_MCA_btl_tcp_if_include=lo OMPI_MCA_plm_rsh_agent=/bin/false
fail() {
    echo "$1"
    cat out 2>/dev/null || true
    exit 1
}
awk 'BEGIN {
    for (i = 0; i <= 24; i++) printf "v %d 0 0\nv %d 1 %g\nvt %g 0\nvt %g 1\n", i, i, i % 3 / 4, i / 24, i / 24
    for (i = 0; i < 24; i++) {
        a = 2 * i + 1
        if (i == 7) printf "f %d %d %d %d\n", a, a + 2, a + 3, a + 1
        else printf "f %d/%d %d/%d %d/%d %d/%d\n", a, a, a + 2, a + 2, a + 3, a + 3, a + 1, a + 1
    }
}' >strip.obj
"$selvage" bake strip.obj --rays ao --samples 64 --size 16 -o image.ptx --quiet
"$selvage" unbake image.ptx --mesh strip.obj --size 64 -o image.png --quiet

# Rays, an image with faces that miss, a budget, an error target: as one process has it.
bake() { # NAME START...
    name=$1
    shift
    "$@" bake strip.obj --rays ao --samples 128 --size 16 -o "$name.rays.ptx" --quiet
    "$@" bake strip.obj --uv image.png --match 4 --max-miss 1 --miss-map "$name.map.ptx" -o "$name.uv.ptx" --json >"$name.json"
    "$@" bake strip.obj --uv image.png --error 1/16 --max-miss 1 --max-over 1 -o "$name.error.ptx" --quiet
}
bake plain "$selvage"
for n in 1 2 4; do
    bake "n$n" mpirun -n "$n" "$selvage" 2>out || fail "$n processes"
    for what in rays uv map error; do
        cmp "plain.$what.ptx" "n$n.$what.ptx" || fail "$n processes make another $what.ptx"
    done
    sed "s/n$n\././" "n$n.json" >a
    sed "s/plain\././" plain.json >b
    cmp a b || fail "$n processes tell something else"
done

# What is wrong is told once or a rank each, and soon; nothing is written.
if mpirun -n 3 "$selvage" bake missing.obj --rays ao -o none.ptx >out 2>&1; then fail "a missing mesh"; fi
grep -q "missing.obj" out || fail "which mesh is missing"
[ ! -e none.ptx ] || fail "a file of nothing"

# A rank that is killed while texels are baked ends all, and the old file stays.
cp plain.rays.ptx old.ptx
mpirun -n 3 "$selvage" bake strip.obj --rays ao --samples 65536 --size 16 -o old.ptx --resume --quiet >out 2>&1 &
running=$!
for _ in $(seq 1200); do
    [ ! -s old.ptx.part ] || break
    sleep 0.05
done
[ -s old.ptx.part ] || fail "no rank bakes anything"
victim=$(pgrep -P "$running" | sed -n 3p)
[ -n "$victim" ] || fail "no ranks"
kill -9 "$victim"
if wait "$running"; then fail "exit code 0 with a rank killed"; fi
running=
grep -q "signal 9" out || fail "no message of a rank that was killed"
cmp old.ptx plain.rays.ptx || fail "the old file is another"
ls | grep -v -E '^(a|b|out|image\.(ptx|png)|strip\.obj|old\.ptx(\.part)?|(plain|n[124])\..*)$' && fail "something was left"
echo "the same bytes by 1, 2 and 4 processes"
