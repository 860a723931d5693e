#!/bin/sh
# What else is painted with: the resolution brush, and an image before the picture. paint_with.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

"$bin/selvage" new "$2/cube.obj" "$here/cube.ptx" --size 16 -q
"$bin/selvage" render "$here/cube.ptx" "$here/image.png" --size 80x40 -q
start_display
start_studio --size 400x300 "$here/cube.ptx"
take_window

# what the session holds now, as a texture: of a copy, since the window has the session itself
export_to() { # PATH
    rm -rf "$here/copy.selvage"
    cp -r "$here"/state/selvage/unfinished/cube*.selvage "$here/copy.selvage"
    "$bin/selvage" session "$here/copy.selvage" --export "$1" -q
}
faces_of() { # SIZE: how many there are
    export_to "$here/now.ptx"
    "$bin/selvage" info "$here/now.ptx" --faces | grep -c "^ *[0-9]*  *$1 x $1 " || true
}

# size and opacity by a drag with Ctrl: 30 pixels to the right, 100 down
key tool b
xdotool keydown ctrl
drag '"event":"brush"' 1 0 -50 3 10 10
xdotool keyup ctrl
grep -q '"event":"brush","radius":50.0,"opacity":0.500' "$log" || fail "the drag has not changed size and opacity"
xdotool keydown ctrl
drag '"event":"brush"' 1 0 50 -3 -10 10
xdotool keyup ctrl

# the resolution brush: a drag over faces is one entry of the history, and more texels where it was
key tool r
drag '"event":"done","name":"faces-finer"' 1 -40 10 10 0 8
finer=$(grep '"name":"faces-finer"' "$log" | head -n 1 | sed 's/.*"target":"\([0-9 ]*\) ".*/\1/' | wc -w)
[ "$finer" -gt 1 ] || fail "the brush touched $finer faces"
[ "$(faces_of 32)" = "$finer" ] || fail "other faces than $finer have more texels"
does '"event":"done","name":"faces-coarser"' keydown shift mousemove "$middle_x" $((middle_y - 40)) mousedown 1 mouseup 1 keyup shift
[ "$(faces_of 8)" -gt 0 ] || fail "no face has fewer texels"
key undo ctrl+z
key undo ctrl+z
# with a density as its aim it gives all faces that, however many texels they had
xdotool mousemove $middle_x $middle_y
key density-take ctrl+t
xdotool mousemove $middle_x $((middle_y - 40))
key texels-more ctrl+plus
[ "$(faces_of 32)" = 1 ] || fail "not one face has more texels"
drag '"event":"done","name":"faces-density"' 1 0 -40 0 10 8
[ "$(faces_of 16)" = 6 ] || fail "not all faces have the density that was aimed for"
key density-more ctrl+bracketright
key density-more ctrl+bracketright
does '"event":"done","name":"faces-density"' mousemove $middle_x $middle_y mousedown 1 mouseup 1
[ "$(faces_of 32)" -gt 0 ] || fail "twice the density is not twice the texels"
key undo ctrl+z
key density-none ctrl+shift+t
key undo ctrl+z
key undo ctrl+z
[ "$(faces_of 16)" = 6 ] || fail "undoing twice does not bring the sizes back"

# no face is given more texels than can be painted fluently, and it is said
xdotool mousemove "$middle_x" "$middle_y"
for _ in 1 2 3 4 5 6; do key texels-more ctrl+plus; done
[ "$(faces_of 1024)" = 1 ] || fail "no face has 1024 texels each way"
does '"event":"said"' key ctrl+plus
[ "$(faces_of 1024)" = 1 ] || fail "a face has more than 1024 texels each way"
for _ in 1 2 3 4 5 6; do key undo ctrl+z; done

# a gradient, from the brush's colour where a drag begins to the other one where it ends; one that ends beside the surface is none
key tool shift+g
drag '"event":"said"' 1 0 0 0 -18 10
drag '"event":"done","name":"fill-gradient"' 1 -60 0 12 0 10
grep -q '"gradient":{"from":\[.*\],"to":\[.*\],"color":\[1.0,1.0,1.0\],"radial":false}' "$here"/state/selvage/unfinished/*/journal ||
    fail "the gradient is not in the journal"
export_to "$here/gradient.ptx"
"$bin/selvage" diff "$here/cube.ptx" "$here/gradient.ptx" >/dev/null && fail "the gradient has painted nothing"
does '"event":"chooser"' key F12
choose '"event":"screenshot"' "$here/gradient.png"
red_at() { # X: of the screenshot, how much more red than green, in hundredths
    convert "$here/gradient.png" -format "%[fx:int(100*(p{$((width / 2 + $1)),$((height / 2))}.r-p{$((width / 2 + $1)),$((height / 2))}.g))]" info:
}
[ "$(red_at -55)" -gt 40 ] && [ "$(red_at 55)" -lt 15 ] || fail "the gradient goes from $(red_at -55) to $(red_at 55)"
key colors-swap shift+x
key gradient-round ctrl+g
drag '"event":"done","name":"fill-gradient"' 1 0 0 6 0 10
grep -q '"color":\[1.0,1.0,1.0\].*"radial":true}' "$here"/state/selvage/unfinished/*/journal || fail "the gradient is not round"
key colors-swap shift+x
key undo ctrl+z
key undo ctrl+z

# an image before the picture: beside it nothing is painted, through it its colours are
does '"event":"chooser"' key ctrl+y
choose '"event":"done","name":"stencil-path"' "$here/image.png"
drag '"event":"view"' 1 0 0 0 50 4 # below where the stroke goes
key tool b
drag '"event":"stroke"' 1 -60 -100 15 0 8
export_to "$here/beside.ptx"
"$bin/selvage" diff "$here/cube.ptx" "$here/beside.ptx" >/dev/null || fail "beside the image something was painted"
key tool y
drag '"event":"view"' 1 0 0 0 -50 4
key tool b
drag '"event":"stroke"' 1 -60 0 15 0 8
tail -n 1 "$here"/state/selvage/unfinished/*/journal | grep -q '"image":{"file":"image-[0-9a-f]*-image.png","at":\[' ||
    fail "the image is not in the journal"
export_to "$here/through.ptx"
"$bin/selvage" diff "$here/cube.ptx" "$here/through.ptx" >/dev/null && fail "through the image nothing was painted"
key stencil-none shift+y
drag '"event":"stroke"' 1 -60 20 15 0 8
tail -n 1 "$here"/state/selvage/unfinished/*/journal | grep -q '"image"' && fail "the image is still there"
[ -z "${SELVAGE_STUDIO_SHOT:-}" ] || import -window root "$SELVAGE_STUDIO_SHOT"
kill -9 "$studio"
wait "$studio" 2>/dev/null || true
studio=
silent
