#!/bin/sh
# A monkey: keys and drags by chance, the same for the same SELVAGE_MONKEY_SEED (1), so many as SELVAGE_MONKEY_STEPS (60) says, or for
# SELVAGE_MONKEY_SECONDS. What took longest is said. No crash, no OpenGL error, nothing on the terminal, and no memory that grows without end. monkey.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

seconds=${SELVAGE_MONKEY_SECONDS:-0}
steps=${SELVAGE_MONKEY_STEPS:-60}
[ "$seconds" = 0 ] || steps=1000000
"$bin/selvage" new "$2/cube.obj" "$here/cube.ptx" --size 16 -q
start_display
start_studio --size 320x200 "$here/cube.ptx"
take_window

# what would leave the window, and what opens another, is not among them
keys="1 2 3 4 5 6 7 8 bar d k Escape t v b e g i s f o c l w u x p period comma bracketleft bracketright ctrl+z ctrl+z
ctrl+shift+z ctrl+shift+n ctrl+j ctrl+m ctrl+Up ctrl+Down ctrl+h ctrl+plus ctrl+minus ctrl+k ctrl+Delete F5 shift+F5 j
r a y greater less ctrl+minus ctrl+minus ctrl+minus h shift+h alt+2 alt+4 alt+5 alt+0 Page_Up Page_Down shift+c shift+Page_Up alt+d
shift+l F2 F3 braceleft ctrl+t ctrl+bracketright ctrl+shift+t ctrl+d"
awk -v seed="${SELVAGE_MONKEY_SEED:-1}" -v steps="$steps" -v keys="$keys" -v x="$middle_x" -v y="$middle_y" '
function below(n) { state = (state * 1103515245 + 12345) % 2147483648; return int(state / 65536) % n }
BEGIN {
    state = seed
    n = split(keys, list, /[ \n]+/)
    for (i = 0; i < steps; i++)
        if (below(3)) {
            print "key " list[1 + below(n)]
        } else {
            line = "mousemove " x - 80 + below(160) " " y - 60 + below(120) " mousedown " 1 + below(3)
            button = substr(line, length(line))
            for (k = below(6); k >= 0; k--) line = line " mousemove_relative -- " below(31) - 15 " " below(31) - 15
            if (!below(4)) line = line " key ctrl+z"
            print line " mouseup " button
        }
}' >"$here/script"

memory() { awk '/^VmRSS/ { print $2 }' "/proc/$studio/status"; }
n=0
half=0
began=$(date +%s)
while read -r line; do
    # shellcheck disable=SC2086
    xdotool $line
    n=$((n + 1))
    if [ $((n % 20)) = 0 ]; then # it keeps up: what it is asked for is done
        xdotool key Escape
        key compare Escape
        passed=$(($(date +%s) - began))
        [ $n -lt $((steps / 2)) ] && { [ "$seconds" = 0 ] || [ $passed -lt $((seconds / 2)) ]; } || [ $half != 0 ] || half=$(memory)
        [ "$seconds" = 0 ] || [ $passed -lt "$seconds" ] || break
    fi
    kill -0 "$studio" 2>/dev/null || fail "the studio has ended at step $n: $line"
done <"$here/script"
key tool v
now=$(memory)
echo "$n steps, $half kB at half of them, $now kB now"
# from an action to its end, a picture, and anything for which the window takes nothing; with that what the processors worked in it
awk '{ match($0, /"t":[0-9.]*/); t = substr($0, RSTART + 4, RLENGTH - 4) }
    function field(name) { return match($0, "\"" name "\":[0-9.]*") ? substr($0, RSTART + length(name) + 3, RLENGTH - length(name) - 3) + 0 : 0 }
    /"event":"action"/ { began = t; match($0, /"name":"[a-z-]*"/); name = substr($0, RSTART + 8, RLENGTH - 9) }
    /"event":"done"/ && t - began > most { most = t - began; longest = name }
    field("ms") > picture { picture = field("ms") }
    field("seconds") > held { held = field("seconds"); worked = field("worked"); after = name }
    END { printf "longest: %s %.3f s, a picture %.3f s, held %.3f s (worked %.3f s) at %s\n", longest, most, picture / 1000, held, worked, after }' "$log"
[ "$half" = 0 ] || [ "$now" -lt $((half + half / 2 + 65536)) ] || fail "memory has grown from $half to $now kB"
! grep -q 'gl-error' "$log" || fail "OpenGL has reported errors"
does '"event":"question"' key ctrl+q
answer alt+n 1
ends
silent
