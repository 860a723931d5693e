#!/bin/sh
# What lies beside the picture: colours that are kept, and the history as a list. panels.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

"$bin/selvage" new "$2/cube.obj" "$here/cube.ptx" --size 16 -q
start_display
start_studio --size 320x640 "$here/cube.ptx"
take_window
wait_for '"event":"swatches"'
click_at() { # WORDS X Y
    does "$1" mousemove "$2" "$3" click 1
}

# at rest the seam jump is measured by itself: of clamp, and of another strategy as soon as that is shown
wait_for '"event":"seam","strategy":"traverse","max":0,"mean":0,"edges":12'
# (what takes a while before a picture is said before it)
told=$(count_of '"event":"preparing"')
does '"event":"seam","strategy":"clamp"' key 1
[ "$(count_of '"event":"preparing"')" = $((told + 1)) ] || fail "nothing was said before another strategy was made ready"

# a colour of the list, then the brush's own is kept as the first of them
click_at '"event":"done","name":"color"' $(($(field x swatches) + 10)) $(($(field y swatches) + 12))
key tool b
drag '"event":"stroke"' 1 -60 0 15 5 8
journal=$(ls "$here"/state/selvage/unfinished/*/journal)
tail -n 1 "$journal" | grep -q '"color":\[0.0,0.0,0.0\]' || fail "the first colour of the list is not black"
key tool e
drag '"event":"stroke"' 1 -20 0 5 5 4
does '"event":"seam","strategy":"clamp","max":[0-9.]*[1-9]' key j # not before texels are others
key tool g
click_at '"event":"done","name":"fill-face"' $middle_x $middle_y
key swatch-add a

# the list's first row is what was opened; its last one is all that was done
lines=$(wc -l <"$journal")
click_at '"event":"done","name":"history"' $(($(field x history) + 20)) $(($(field y history) + 8))
[ "$(tail -n "+$((lines + 1))" "$journal" | grep -c '"op":"undo"')" = 3 ] || fail "the first row does not undo all"
key history End
[ "$(grep -c '"op":"redo"' "$journal")" = 3 ] || fail "the last row does not bring all back"
key history Up
[ "$(grep -c '"op":"undo"' "$journal")" = 4 ] || fail "the row above undoes another number of things"

# a drag of the layer's opacity is one thing to undo
refined
lines=$(wc -l <"$journal")
x=$(($(field x opacity) + $(field width opacity) - 12)) y=$(($(field y opacity) + $(field height opacity) / 2))
steps=$(for _ in 1 2 3 4 5 6 7 8; do echo mousemove_relative -- -4 0 sleep 0.1; done)
# shellcheck disable=SC2086
does '"event":"done","name":"layer-opacity"' mousemove $x $y mousedown 1 $steps mouseup 1
[ "$(wc -l <"$journal")" = $((lines + 1)) ] || fail "a drag of the opacity is more than one thing to undo"

# the panel has the times of processor and GPU apart
grep '"event":"times"' "$log" | tail -n 1 | grep -q '"cpu_ms":[0-9.]*[1-9][0-9]*,"gpu_ms":[-0-9.]*' ||
    fail "no times were told"

# all keys in a window of their own, about which the toolkit has nothing to say
key shortcuts F1
until [ -n "$(other_window)" ]; do sleep 0.05; done
sleep 0.5
until [ -z "$(other_window)" ]; do
    xdotool windowfocus "$(other_window)" key Escape || true
    sleep 0.2
done
xdotool windowfocus --sync "$window"

# saving where nobody has said where to yet asks for that, and then goes on with the end; the colours are kept
does '"event":"question"' key ctrl+q
answer Return 0
choose '"event":"saved"' "$here/kept.ptx"
ends
[ -f "$here/kept.ptx" ] || fail "nothing was saved"
[ -z "$(ls "$here/state/selvage/unfinished")" ] || fail "what was saved is still unfinished work"
grep -q '^swatches=#000000;#ffffff;' "$here/config/selvage/studio.ini" || fail "the colours are not kept"
silent
