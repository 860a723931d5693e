#!/bin/sh
# Pens and mice: 200 motions are 200 samples, however few events they come in; the log of a pen, played where the toolkit's
# events end, brings pressure, tilt and eraser to the dabs. pen.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

"$bin/selvage" new "$2/cube.obj" "$here/cube.ptx" --size 32 -q
start_display
mkfifo "$here/pen"
sleep 1000 >"$here/pen" 2>/dev/null & # keeps it open
keeper=$!
start_studio --size 320x200 --pen "$here/pen" "$here/cube.ptx"
take_window
key tool b

drag '"event":"stroke"' 1 -100 -40 1 0 200
journal=$(ls "$here"/state/selvage/unfinished/*/journal)
count=$(tail -n 1 "$journal" | sed 's/.*"samples":\[\(.*\)\]\],.*/\1/; s/\],\[/\n/g' | grep -c ,)
[ "$count" = 201 ] || fail "200 motions and a press gave $count samples"

# a stroke that presses harder and harder, and one with the eraser's end
x=$((width / 2 - 20)) y=$((height / 2 - 10))
stroke() { # ERASER
    echo "down 0 $x $y 0.1 0 0 ${1:-}"
    for i in 1 2 3 4 5 6 7 8; do echo "move $((8 * i)) $((x + 4 * i)) $((y + i)) 0.$i 0.25 -0.5"; done
    echo "up 80 0 0 0 0 0"
}
wanted=$(($(count_of '"event":"stroke"') + 1))
stroke >"$here/pen"
wait_for '"event":"stroke"' $wanted
tail -n 1 "$journal" | grep -q "\"samples\":\[\[$x.0,$y.0,0.1[0-9]*,0.0,0.0,0.0\],\[$((x + 4)).0,$((y + 1)).0,0.1[0-9]*,0.008[0-9]*,0.25,-0.5\]" ||
    fail "pressure, time and tilt are not in the journal"
tail -n 1 "$journal" | grep -q '"erase":false' || fail "the pen erases"
stroke eraser >"$here/pen"
wait_for '"event":"stroke"' $((wanted + 1))
tail -n 1 "$journal" | grep -q '"erase":true' || fail "the eraser's end does not erase"
kill -9 "$studio"
wait "$studio" 2>/dev/null || true
studio=
silent
