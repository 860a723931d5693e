#!/bin/sh
# The window by real events: open, orbit, switch strategies, split, paint, undo, redo, a layer, more texels, save, close, reopen.
# What was saved is, to the byte, what the command makes of the same script without a window. session.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

"$bin/selvage" new "$2/cube.obj" "$here/cube.ptx" --size 32 -q
start_display
start_studio --size 700x400 "$here/cube.ptx"
take_window

drag '"event":"view"' 1 0 0 12 3 6
grep -q '"event":"view","azimuth":1.2' "$log" || fail "the view was not turned by 72 pixels"
key strategy 1
key strategy 2
key compare bar
key other-next t
drag '"event":"view"' 1 0 40 10 0 4 # the divider
key compare Escape
key frame f

key tool b
drag '"event":"stroke"' 1 -60 0 15 5 8
dabs=$(grep '"event":"stroke"' "$log" | tail -n 1 | sed 's/.*"dabs":\([0-9]*\).*/\1/')
[ "$dabs" -gt 3 ] || fail "a stroke over the cube made $dabs dabs"
key undo ctrl+z
key redo ctrl+shift+z
key layer-add ctrl+shift+n
drag '"event":"stroke"' 1 20 -60 -4 14 8
xdotool mousemove $middle_x $middle_y
key texels-more ctrl+plus
does '"event":"chooser"' key ctrl+s
choose '"event":"saved"' "$here/cube.selvage"
does '"event":"chooser"' key ctrl+e
choose '"event":"exported"' "$here/window.ptx"
xdotool key ctrl+q
ends
silent
[ ! -d "$here/state/selvage/unfinished" ] || [ -z "$(ls "$here/state/selvage/unfinished")" ] ||
    fail "unfinished work is left"

# where the pointer was is where the paint is
x=$((middle_x - 60 - left)) y=$((middle_y - top))
grep -o '"samples":\[\[[0-9.]*,[0-9.]*,1.0,' "$here/cube.selvage/journal" | head -n 1 | tr -c '0-9.\n' ' ' |
    awk -v x=$x -v y=$y '{ exit !(sqrt(($1 - x) ^ 2 + ($2 - y) ^ 2) < 0.001 && $3 == 1) }' ||
    fail "the first sample is not at $x, $y"

# the same without a window: the session's first lines are what makes it
tail -n +4 "$here/cube.selvage/journal" >"$here/script"
[ "$(grep -c '"samples"' "$here/script")" = 2 ] || fail "the journal has not two strokes"
"$bin/selvage" session "$here/copy.selvage" --new "$here/cube.ptx" --script "$here/script" --save --export "$here/copy.ptx" -q
cmp "$here/window.ptx" "$here/copy.ptx" || fail "the texture that was saved is another one"
cmp "$here/cube.selvage/$(ls "$here/cube.selvage" | grep '^state' | tail -n 1)" \
    "$here/copy.selvage/$(ls "$here/copy.selvage" | grep '^state' | tail -n 1)" || fail "the session is another one"
"$bin/selvage" diff "$here/cube.ptx" "$here/window.ptx" >"$here/diff" && fail "nothing was painted"
grep -q 64 "$here/diff" || fail "no face has more texels"

# again, from the session
start_studio --size 700x400 "$here/cube.selvage"
take_window
does '"event":"chooser"' key ctrl+e
choose '"event":"exported"' "$here/undone.ptx"
xdotool key ctrl+q
ends
silent
cmp "$here/undone.ptx" "$here/copy.ptx" || fail "the session that was opened again is another one"
