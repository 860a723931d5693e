#!/bin/bash
# Runs `selvage compare` on the demo scene again and again, and says how often the advice was the same; by hand, since it
# takes minutes: advice.sh [BUILD [RUNS]]. Half of the runs have a processor kept busy beside them. Exits with 1 if one run
# gave another answer.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
build=${1:-$root/build} runs=${2:-10}
if ! [ -x "$build/bin/selvage" ] || ! [ "$runs" -gt 0 ]; then
    echo "usage: $0 [BUILD [RUNS]]" >&2
    exit 2
fi
work=$(mktemp -d)
busy=
trap 'kill $busy 2>/dev/null || true; rm -rf "$work"' EXIT
"$build/bin/selvage-assets" "$work/demo" >/dev/null
for ((run = 1; run <= runs; run++)); do
    if [ "$run" = $((runs / 2 + 1)) ]; then
        while :; do :; done &
        busy=$!
    fi
    "$build/bin/selvage" compare "$work/demo/scene_faces.ptx" --mesh "$work/demo/scene.obj" --focus creature --quick \
        --out "$work/report" >"$work/said"
    advice=$(sed -n 's/^ *"advice": "\([^"]*\)".*/\1/p' "$work/report/report.json")
    [ "$advice" ] || { echo "run $run: no advice in report.json" >&2; exit 1; }
    echo "run $run${busy:+, a processor busy}: $advice"
    echo "$advice" >>"$work/all"
    rm -rf "$work/report"
done
sort "$work/all" | uniq -c | sort -rn | while read -r count advice; do
    echo "$advice: $count of $runs"
done
[ "$(sort -u "$work/all" | wc -l)" = 1 ]
