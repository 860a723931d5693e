#!/bin/bash
# Frames of the demo scene with two builds by turns, on a software driver: how many times as fast the new one draws each
# strategy with the same triangles, in processor time. By hand, since it takes minutes: frames.sh OLD_BUILD NEW_BUILD [ROUNDS].
# Each build lies in the folder of its sources.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
old=${1:-} new=${2:-} rounds=${3:-5}
if ! [ -d "$old/lib" ] || ! [ -x "$new/bin/selvage-assets" ] || ! [ "$rounds" -gt 0 ]; then
    echo "usage: $0 OLD_BUILD NEW_BUILD [ROUNDS]" >&2
    exit 2
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$new/bin/selvage-assets" "$work/demo" >/dev/null
for which in old new; do
    build=$(cd "${!which}" && pwd)
    cc -std=gnu17 -O1 "$here/frames.c" -o "$work/$which" -I"$build/../runtime/include" -L"$build/lib" -lselvage-gl -lselvage \
        -Wl,-rpath,"$build/lib"
done
export LP_NUM_THREADS=1
for setting in "4 16" "1 1"; do
    read -r msaa anisotropy <<<"$setting"
    : >"$work/times"
    for ((round = 0; round < rounds; round++)); do
        for which in old new; do
            "$work/$which" "$work/demo/scene.obj" "$work/demo/scene.ptx" $setting | sed "s/^/$round $which /" >>"$work/times"
        done
    done
    echo "${msaa}x MSAA, ${anisotropy}x anisotropy: median of $rounds rounds; ms before, ms after, times as fast"
    for strategy in $(awk '!seen[$3]++ { print $3 }' "$work/times"); do
        awk -v s="$strategy" '$3 == s { if ($2 == "old") before[$1] = $4; else print $4 / before[$1], before[$1], $4 }' \
            "$work/times" | sort -g | awk -v s="$strategy" '{ row[NR] = $0 }
                END { split(row[int((NR + 1) / 2)], m, " "); printf "  %-14s %8.1f %8.1f %6.2f\n", s, m[2], m[3], 1 / m[1] }'
    done
done
