#!/bin/sh
# What the window shows is what the command draws of the same view, within a tolerance; view files go out and in again; overlays,
# other levels and turntables are other pictures. looks.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

"$bin/selvage" bake "$2/cube.obj" "$here/cube.ptx" --pattern checker --frequency 4 -q
start_display
start_studio --size 320x200 "$here/cube.ptx"
take_window

take() { # NAME
    does '"event":"chooser"' key F12
    choose '"event":"screenshot"' "$here/$1.png"
}
# How far two pictures are apart, root mean square, is less than so many thousandths of the range (lt), or more (gt).
apart() { # A B lt|gt THOUSANDTHS
    measured=$(compare -metric RMSE "$here/$1.png" "$here/$2.png" "$here/apart.png" 2>&1 | sed 's/.*(\(.*\)).*/\1/' || true)
    echo "$1 and $2 are $measured apart"
    awk -v d="$measured" -v most="$4" -v how="$3" 'BEGIN { exit !(how == "lt" ? 1000 * d < most : 1000 * d > most) }' ||
        fail "$1 and $2 are $measured apart"
}
render() { # NAME: of the view file
    "$bin/selvage" render "$here/cube.ptx" "$here/$1.png" --view "$here/view.json" --background 0.03,0.03,0.035 -q
}

drag '"event":"view"' 1 0 0 12 3 6
take window
does '"event":"chooser"' key F9
choose '"event":"view-saved"' "$here/view.json"
render command
apart window command lt 8

key bias-up greater
key bias-up greater
key bias-up greater
take biased
apart window biased gt 20
for i in 1 2 3; do key bias-down less; done

# a view file brings the view back; on the way there are pictures from all around
key frame f
key face-front KP_1
does '"event":"chooser"' key F8
choose '"event":"view-opened"' "$here/view.json"
does '"event":"question"' key shift+F12
answer_with 12
choose '"event":"turntable"' "$here/turn-##.png"
[ "$(ls "$here" | grep -c '^turn-[0-9][0-9].png$')" = 12 ] || fail "there are not 12 pictures"
apart window turn-01 lt 1
if [ -n "${SELVAGE_TEST_EFFORT:-}" ]; then
    key report-orbit ctrl+shift+r
    wait_for '"event":"report"'
    "$bin/selvage" render "$here/cube.ptx" "$here/command-##.png" --view "$here/view.json" --background 0.03,0.03,0.035 --turntable 12 -q
    apart turn-10 command-10 lt 8
fi
# square faces are the same by even levels
key even-levels shift+l
take even
apart window even lt 8
key even-levels shift+l

# in the light of an image, turned
convert -size 64x32 'gradient:#ffe0b0-#203060' "$here/sky.png"
does '"event":"chooser"' key ctrl+i
choose '"event":"done","name":"light-path"' "$here/sky.png"
key light-right braceright
take lit
apart window lit gt 20
does '"event":"chooser"' key F9
choose '"event":"view-saved"' "$here/view.json"
render lit-command
apart lit lit-command lt 8

# moved by what the texture says itself, as the command has it
key frame f
key displace-channel shift+c
key displace-more shift+Page_Up
key displace-more shift+Page_Up
take moved
apart lit moved gt 20
does '"event":"chooser"' key F9
choose '"event":"view-saved"' "$here/view.json"
render moved-command
apart moved moved-command lt 8
key displace-none alt+d
key exposure-up period
key encoding ctrl+2
xdotool key ctrl+q
ends

# a face of which the texels are spoilt is filled, and shown; the others of that overlay are darker
cp "$here/cube.ptx" "$here/hurt.ptx"
printf 'spoilt spoilt spoilt spoilt' | dd of="$here/hurt.ptx" bs=1 seek=2000 conv=notrunc 2>/dev/null
start_studio --size 320x200 "$here/hurt.ptx"
take_window
wait_for '"event":"said"'
take hurt
# the light, and what else was chosen, is as it was
does '"event":"chooser"' key F9
choose '"event":"view-saved"' "$here/view.json"
grep -q '"light": ".*/sky.png"' "$here/view.json" && grep -q '"turn": 15' "$here/view.json" || fail "the light was not kept"
grep -q '^exposure=0.25' "$here/config/selvage/studio.ini" || fail "the exposure was not kept"
grep -q '^encoding=linear' "$here/config/selvage/studio.ini" || fail "the encoding was not kept"
key overlay alt+5
take damaged
apart hurt damaged gt 20
key overlay alt+4 # nothing is widened with this strategy: all are darker
take widened
apart hurt widened gt 20
[ -z "${SELVAGE_STUDIO_SHOT:-}" ] || import -window root "$SELVAGE_STUDIO_SHOT"
xdotool key ctrl+q
ends
silent
