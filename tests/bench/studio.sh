#!/bin/sh
# How fluent the window is: pictures a second while the view is turned and while a large brush paints, 960x540, on the demo scene and on
# one of 100,000 faces; and what starting takes. studio.sh BIN ASSETS [--smoke]
. "$(dirname "$0")/../studio/kit.sh"

size=960x540 turns=60
if [ "${3:-}" = --smoke ]; then
    size=320x180 turns=4
else
    unset GALLIVM_PERF LP_NUM_THREADS # as users have it
fi
start_display 1400x900

moment() { date +%s.%N; }
# Of the pictures that came after a line of the log: how many a second, the mean of their scale.
rate() { # NAME FIRST-LINE
    tail -n "+$2" "$log" | grep '"event":"frame"' | grep '"refined":false' | awk -v name="$1" '{
        match($0, /"t":[0-9.]*/); t = substr($0, RSTART + 4, RLENGTH - 4)
        match($0, /"scale":[0-9.]*/); scale += substr($0, RSTART + 8, RLENGTH - 8)
        match($0, /"ms":[0-9.]*/); ms += substr($0, RSTART + 5, RLENGTH - 5)
        if (!n++) first = t
    } END { if (n > 1) printf "%-28s %5.1f pictures a second, %.1f ms each, scale %.2f\n", name, (n - 1) / (t - first), ms / n, scale / n }'
}
measure() { # NAME FILE
    began=$(moment)
    start_studio --size $size "$2"
    wait_for '"event":"window"'
    shown=$(moment)
    take_window
    echo "$began $shown $(moment)" | awk -v name="$1" '{ printf "%-28s window %.2f s, picture %.2f s\n", name ": start", $2 - $1, $3 - $1 }'
    first=$(($(wc -l <"$log") + 1))
    drag '"event":"view"' 1 0 0 3 1 $turns
    rate "$1: turning" $first
    key tool b
    first=$(($(wc -l <"$log") + 1))
    drag '"event":"stroke"' 1 -60 20 2 0 $turns
    rate "$1: painting" $first
    xdotool key ctrl+q
    wait_for '"event":"question"'
    answer alt+n 1
    ends
}
# one motion after the other, as a hand makes them
drag() {
    xdotool mousemove $((middle_x + $3)) $((middle_y + $4)) mousedown "$2"
    for i in $(seq "$7"); do xdotool mousemove_relative -- "$5" "$6"; done
    does "$1" mouseup "$2"
}

"$bin/selvage-assets" "$here/demo" >/dev/null
measure demo "$here/demo/scene_faces.ptx"
if [ "${3:-}" != --smoke ]; then
    awk 'BEGIN { n = 316
        for (i = 0; i <= n; i++) for (k = 0; k <= n; k++) printf "v %g %g %g\n", k / n, 0.02 * sin(i / 9) * cos(k / 7), i / n
        for (i = 0; i < n; i++) for (k = 1; k <= n; k++) { a = i * (n + 1) + k; print "f", a, a + n + 1, a + n + 2, a + 1 } }' >"$here/large.obj"
    "$bin/selvage" new "$here/large.obj" "$here/large.ptx" --size 8 -q
    measure "100,000 faces" "$here/large.ptx"
fi
silent
