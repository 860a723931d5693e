#!/bin/sh
# Makes the pictures of studio.md: drives the window over the demo scene by real events, and takes what is on the display.
#   docs/studio_pictures.sh build/bin
here_docs=$(cd "$(dirname "$0")" && pwd)
. "$here_docs/../tests/studio/kit.sh"
unset GALLIVM_PERF LP_NUM_THREADS # as users have it: the pictures say how long they took

take() { # NAME
    xdotool mousemove 5 5
    refined_now
    import -window "$window" +dither -colors 128 "$here_docs/images/$1.png"
}
# The last picture is a refined one of what was done last, and is on the display: panels follow it then.
refined_now() {
    tries=0
    until awk '/"event":"(done|stroke|view|preparing)"/ { r = 0 } /"event":"frame"/ { r = /"refined":true/ }
               /"event":"history"/ && r { r = 2 } END { exit r != 2 }' "$log"; do
        tries=$((tries + 1))
        [ $tries -lt 1200 ] || fail "no refined picture"
        sleep 0.05
    done
}

"$bin/selvage-assets" "$here/demo" >/dev/null
start_display 1000x900
start_studio --size 660x720 "$here/demo/scene_faces.ptx"
take_window
for i in 1 2 3 4 5 6; do xdotool mousemove $middle_x $((middle_y + 20)) click 4; done
key strategy 1
key compare bar
key other-next t
key seams l
take studio_split
key seams l
key compare Escape
key tool b
drag '"event":"stroke"' 1 -120 30 12 -3 16
key layer-add ctrl+shift+n
take studio
kill -9 "$studio"
wait "$studio" 2>/dev/null || true
studio=

# another scene, in the light of an image that is bright on one side, moved by its own colours
convert -size 256x128 gradient:'#c8dcff-#503820' -fill '#fff0c0' -draw 'rectangle 20,30 70,60' "$here/sky.png"
start_studio --size 660x720 "$here/demo/scene.ptx"
take_window
for i in 1 2 3 4 5 6; do xdotool mousemove $middle_x $((middle_y + 20)) click 4; done
does '"event":"chooser"' key ctrl+i
choose '"event":"done","name":"light-path"' "$here/sky.png"
key displace-channel shift+c
for i in 1 2 3 4 5 6; do key displace-less shift+Page_Down; done
take studio_light
kill -9 "$studio"
wait "$studio" 2>/dev/null || true
studio=
