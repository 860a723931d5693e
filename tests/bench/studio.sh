#!/bin/sh
# How fluent the window is, with the driver's name: what starting takes, pictures a second while the view is turned and while a brush of
# 10,000 texels paints, how old the input in a picture is, and how long refining takes; 960x540, the demo scene and 100,000 faces. Each
# figure stands beside what it should be. studio.sh BIN ASSETS [--smoke]
. "$(dirname "$0")/../studio/kit.sh"

size=960x540 seconds=4
if [ "${3:-}" = --smoke ]; then
    size=320x180 seconds=1
else
    unset GALLIVM_PERF LP_NUM_THREADS # as users have it
fi
start_display 1400x900

ticks=$(getconf CLK_TCK)
spent() { awk '{ print $14 + $15 }' "/proc/$studio/stat"; }
uptime_now() { cut -d ' ' -f 1 /proc/uptime; }
# A figure, what it should be at least (or at most, with a minus before), and whether it is.
say() { # NAME FIGURE UNIT BAR
    awk -v name="$1" -v figure="$2" -v unit="$3" -v bar="$4" 'BEGIN {
        at_most = bar < 0
        held = at_most ? figure <= -bar : figure >= bar
        printf "%-34s %7.2f %-18s (%s %g) %s\n", name, figure, unit, at_most ? "at most" : "at least", at_most ? -bar : bar, held ? "holds" : "MISSED"
    }'
}
# Of the log from a line on: a number of each line of an event.
numbers() { # FIRST-LINE EVENT FIELD
    tail -n "+$1" "$log" | grep "\"event\":\"$2\"" | sed "s/.*\"$3\":\([-0-9.a-z]*\).*/\1/"
}
# A drag back and forth about the middle, with a motion each 4 ms, until its time is over.
drag_on() { # WORDS BUTTON SECONDS
    first=$(($(wc -l <"$log") + 1))
    steps=$(awk -v s="$3" 'BEGIN { for (i = 0; i < s * 250; i++) printf " mousemove_relative -- %d %d sleep 0.004", int(i / 100) % 2 ? -2 : 2, i % 2 }')
    before=$(spent)
    # shellcheck disable=SC2086
    does "$1" mousemove $((middle_x - width / 10)) "$middle_y" mousedown "$2" $steps mouseup "$2"
    after=$(spent)
}
# The pictures of a drag: how many a second, and what each took.
rate() { # NAME BAR
    moving=$(tail -n "+$first" "$log" | grep '"event":"frame"' | grep '"refined":false' | awk '{
        match($0, /"t":[0-9.]*/); t = substr($0, RSTART + 4, RLENGTH - 4)
        match($0, /"scale":[0-9.]*/); scale += substr($0, RSTART + 8, RLENGTH - 8)
        match($0, /"ms":[0-9.]*/); ms += substr($0, RSTART + 5, RLENGTH - 5)
        match($0, /"input_ms":[0-9.]*/); age = substr($0, RSTART + 11, RLENGTH - 11) + 0
        if (n > 1 && age > 0) { aged++; if (age > 1e3 * (t - last2) + 1) late++ }
        if (!n++) from = t
        last2 = last; last = t
    } END { if (n > 1) print (n - 1) / (t - from), ms / n, scale / n, n, late + 0, aged + 0; else print 0, 0, 0, n + 0, 0, 0 }')
    # shellcheck disable=SC2086
    set -- "$1" "$2" $moving
    say "$1" "$3" "pictures a second" "$2"
    awk -v ms="$4" -v scale="$5" -v n="$6" -v cpu="$(((after - before) * 1000 / ticks))" \
        'BEGIN { printf "    %d pictures, %.1f ms each, %.1f ms of processor time (of one alone %.0f a second), at a scale of %.2f\n",
            n, ms, n ? cpu / n : 0, cpu ? 1000 * n / cpu : 0, scale }'
    [ "$8" = 0 ] || say "$1: input older than 2" "$(awk -v l="$7" -v n="$8" 'BEGIN { print 100 * l / n }')" "% of pictures" -1
}
# From the end of a drag to the fine picture.
rest() { # NAME WORDS
    wait_for '"refined":true' $(($(head -n "$((first - 1))" "$log" | grep -c '"refined":true') + 1))
    ended=$(tail -n "+$first" "$log" | grep -e "$2" | tail -n 1 | sed 's/{"t":\([0-9.]*\).*/\1/')
    fine=$(tail -n "+$first" "$log" | grep '"refined":true' | tail -n 1 | sed 's/{"t":\([0-9.]*\).*/\1/')
    say "$1: refined at rest" "$(awk -v a="$ended" -v b="$fine" 'BEGIN { print b - a }')" seconds -1
}
leave() {
    xdotool key ctrl+q
    wait_for '"event":"question"'
    answer alt+n 1
    ends
}
measure() { # NAME FILE MOST-SECONDS TURNING PAINTING
    # once without measuring: shaders are compiled then, whatever was before
    start_studio --size $size "$2"
    take_window
    drag_on '"event":"view"' 1 0.5
    key tool b
    drag_on '"event":"stroke"' 1 $seconds
    leave
    began=$(uptime_now)
    start_studio --size $size "$2"
    take_window
    for what in window frame; do
        at=$(grep -m 1 "\"event\":\"$what\"" "$log" | sed 's/{"t":\([0-9.]*\).*/\1/')
        say "$1: start to $what" "$(awk -v a="$began" -v b="$at" 'BEGIN { print b - a }')" seconds "$([ $what = window ] && echo -1 || echo "$3")"
    done
    drag_on '"event":"view"' 1 $seconds
    rate "$1: turning" "$4"
    rest "$1" '"event":"view"'
    # a brush of 10,000 texels
    key tool b
    texels=0
    while [ "$texels" -lt 10000 ]; do
        does '"event":"stroke"' mousemove "$middle_x" "$middle_y" mousedown 1 mouseup 1
        texels=$(numbers 1 stroke texels | tail -n 1)
        [ "$texels" -gt 0 ] || fail "there is no surface in the middle"
        [ "$texels" -ge 10000 ] || key brush-larger bracketright
    done
    drag_on '"event":"stroke"' 1 $seconds
    rate "$1: painting" "$5"
    echo "    $(numbers "$first" stroke dabs | tail -n 1) dabs of $texels texels"
    rest "$1, painted" '"event":"stroke"'
    leave
}

"$bin/selvage-assets" "$here/demo" >/dev/null
measure demo "$here/demo/scene_faces.ptx" -1.5 20 15
grep '"event":"driver"' "$log" | sed 's/.*"name":"\([^"]*\)".*/driver: \1/'
if [ "${3:-}" != --smoke ]; then
    awk 'BEGIN { n = 316
        for (i = 0; i <= n; i++) for (k = 0; k <= n; k++) printf "v %g %g %g\n", k / n, 0.02 * sin(i / 9) * cos(k / 7), i / n
        for (i = 0; i < n; i++) for (k = 1; k <= n; k++) { a = i * (n + 1) + k; print "f", a, a + n + 1, a + n + 2, a + 1 } }' >"$here/large.obj"
    "$bin/selvage" new "$here/large.obj" "$here/large.ptx" --size 8 -q
    measure "100,000 faces" "$here/large.ptx" -4 10 10
fi
silent
