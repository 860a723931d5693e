#!/bin/sh
# A surface that is displaced is painted where it is seen: what the pointer is over has the colour then, beyond the outline of the
# surface that is not moved too, and the command makes the same of the journal. moved.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

"$bin/selvage" new "$2/cube.obj" "$here/cube.ptx" --size 32 -q
start_display
start_studio --size 400x400 "$here/cube.ptx"
take_window

shot() { # NAME
    does '"event":"chooser"' key F12
    choose '"event":"screenshot"' "$here/$1.png"
}
# Of a screenshot, a channel at a place relative to the middle, 0 to 100.
at() { # NAME X Y CHANNEL
    convert "$here/$1.png" -format "%[fx:int(100*p{$((width / 2 + $2)),$((height / 2 + $3))}.$4)]" info:
}
is_red() { [ $(($(at "$1" "$2" "$3" r) - $(at "$1" "$2" "$3" g))) -gt 20 ]; } # NAME X Y

key face-front KP_1
shot before
key displace-channel shift+c
for i in 1 2 3 4 5 6 7 8 9 10; do key displace-more shift+Page_Up; done
shot moved
# to the left of the middle, the first place that only the moved surface covers
x=0
while [ "$(at before $x 0 b)" -gt 30 ] && [ $x -gt -190 ]; do x=$((x - 5)); done
x=$((x - 5))
[ "$(at moved $x 0 b)" -gt 30 ] || fail "the surface that is moved does not cover $x"

key tool b
drag '"event":"stroke"' 1 $x 0 0 4 5
drag '"event":"stroke"' 1 0 -60 5 3 8
grep '"event":"stroke"' "$log" | head -n 1 | grep -q '"dabs":0' && fail "the stroke missed what is seen"
shot painted
is_red painted $x 10 || fail "there is no paint at $x 10, where the pointer was"
is_red painted 20 -48 || fail "there is no paint at 20 -48, where the pointer was"
is_red moved 20 -48 && fail "there was paint before"
is_red painted 20 0 && fail "there is paint where the pointer was not"

# a click fills the face that is seen there
key undo ctrl+z
key undo ctrl+z
key tool g
does '"event":"done","name":"fill-face"' mousemove $((middle_x + x)) $middle_y mousedown 1 mouseup 1
shot filled
is_red filled $x 0 || fail "the face that was clicked is not filled"

# what goes to the picture alone is refused in words, and nothing is painted
key project p
key tool b
journal=$(ls "$here"/state/selvage/unfinished/*/journal)
lines=$(wc -l <"$journal")
does '"event":"said"' mousemove $middle_x $middle_y mousedown 1 mousemove_relative 5 5 mouseup 1
[ "$(wc -l <"$journal")" = "$lines" ] || fail "it was painted"
key project p
drag '"event":"stroke"' 1 0 -60 5 3 8
does '"event":"chooser"' key ctrl+e
choose '"event":"exported"' "$here/window.ptx"

# the journal says where on the surface it was, so that the command needs no displacement
tail -n 1 "$journal" | grep -q '"camera"' && fail "the line has a camera"
tail -n +4 "$journal" >"$here/script"
"$bin/selvage" session "$here/copy.selvage" --new "$here/cube.ptx" --script "$here/script" --export "$here/copy.ptx" -q
cmp "$here/window.ptx" "$here/copy.ptx" || fail "the texture that was exported is another one"
kill -9 "$studio"
wait "$studio" 2>/dev/null || true
studio=
silent
