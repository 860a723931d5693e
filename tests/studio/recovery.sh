#!/bin/sh
# What can go wrong: kill -9 amid a stroke, a save that fails, closing with unsaved work, files that cannot be opened, a display
# without OpenGL 4.5. Nothing is lost, and all of it is said in the window. recovery.sh BIN ASSETS
. "$(dirname "$0")/kit.sh"

"$bin/selvage" new "$2/cube.obj" "$here/cube.ptx" --size 16 -q
start_display
start_studio --size 320x200 "$here/cube.ptx"
take_window
key tool b
drag '"event":"stroke"' 1 -40 0 10 3 8

# killed while the button is down: the whole stroke before is there, this one is not
does '"event":"samples"' mousemove $middle_x $middle_y mousedown 1 mousemove_relative 5 5
kill -9 "$studio"
wait "$studio" 2>/dev/null || true
xdotool mouseup 1
work=$(ls -d "$here"/state/selvage/unfinished/*.selvage)
"$bin/selvage" session "$work" --export "$here/expected.ptx" -q

start_studio --size 320x200 "$here/cube.ptx"
wait_for '"event":"question"'
take_window
answer Return 0
wait_for '"event":"recovered"'
does '"event":"chooser"' key ctrl+e
choose '"event":"exported"' "$here/back.ptx"
cmp "$here/expected.ptx" "$here/back.ptx" || fail "what was brought back is not what was there"

# a place that takes no files: the work stays, and it is said
does '"event":"chooser"' key ctrl+s
choose '"event":"failed"' /proc/no.selvage
[ -d "$work" ] || fail "a failing save has lost the work"

# closing asks, once however long the keys are held; Escape keeps it open; not saving throws away
asked=$(count_of '"event":"question"')
does '"event":"question"' key ctrl+q ctrl+q ctrl+q ctrl+q
answer Escape 2
key frame f
[ "$(count_of '"event":"question"')" = $((asked + 1)) ] || fail "one question was asked more than once"
does '"event":"question"' key ctrl+q
answer alt+n 1
ends
silent
[ ! -d "$work" ] || fail "what was thrown away is still there"

# what cannot be opened
echo nonsense >"$here/bad.ptx"
mkdir "$here/old.selvage"
printf '{"kind":"selvage session","version":0}\n' >"$here/old.selvage/session.json"
for file in bad.ptx ${SELVAGE_TEST_EFFORT:+missing.ptx} old.selvage; do
    start_studio --size 320x200 "$here/$file"
    wait_for '"event":"failed"'
    window=$(xdotool search --onlyvisible --name 'Selvage Studio' | tail -n 1)
    xdotool windowfocus --sync "$window" key ctrl+q ctrl+q ctrl+q ctrl+q ctrl+q # held
    ends
    silent
done

# a file that takes for ever can be let go, and another one opened meanwhile
mkfifo "$here/slow.obj"
exec 9<>"$here/slow.obj"
: >"$log"
"$bin/selvage-studio" --log "$log" --size 320x200 "$here/slow.obj" >>"$err" 2>&1 & # the command would read the pipe itself
studio=$!
wait_for '"event":"window"'
window=$(xdotool search --onlyvisible --name 'Selvage Studio' | tail -n 1)
xdotool windowfocus --sync "$window"
wait_for '"event":"opening","step":1'
does '"event":"cancelled"' key ctrl+period
does '"event":"chooser"' key ctrl+o
choose '"event":"opened"' "$here/cube.ptx"
exec 9>&-
wait_for '"refined":true'
# one that comes a little at a time says how far it is, to its end
mkfifo "$here/tardy.obj"
does '"event":"chooser"' key ctrl+o
choose '"event":"opening","step":1' "$here/tardy.obj"
timeout 60 sh -c 'cat "$1" >"$2"' - "$2/cube.obj" "$here/tardy.obj" # goes on when somebody reads
wait_for '"event":"opened"' 2
cp "$here/cube.ptx" "$here/again.ptx"
wait_for '"event":"opening","step":4'
# and one more, whose pictures ask nothing of the document that is gone
does '"event":"chooser"' key ctrl+o
wanted_pictures=$(($(count_of '"refined":true') + 1))
choose '"event":"opened"' "$here/again.ptx"
wait_for '"refined":true' $wanted_pictures
# a stroke ends with the button that it began with
take_window
key tool b
does '"event":"samples"' mousemove $middle_x $middle_y mousedown 1 mousemove_relative 5 5
xdotool mousedown 3 mouseup 3
does '"event":"samples"' mousemove_relative 5 5
does '"event":"stroke"' mouseup 1
# what is no file takes nothing away, though it was said that what is open need not be saved
does '"event":"chooser"' key ctrl+o
choose '"event":"question"' "$here/bad.ptx"
answer alt+n 1
wait_for '"event":"failed"'
key undo ctrl+z
# nor does one that was let go because the window is closed
does '"event":"chooser"' key ctrl+o
choose '"event":"question"' "$here/slow.obj"
steps=$(count_of '"event":"opening","step":1')
answer alt+n 1
wait_for '"event":"opening","step":1' $((steps + 1))
does '"event":"question"' key ctrl+q
answer alt+n 1
ends
silent

# no OpenGL 4.5: words in the window
export MESA_GL_VERSION_OVERRIDE=3.3
start_studio --size 320x200 "$here/cube.ptx"
wait_for '"event":"no-gl"'
window=$(xdotool search --onlyvisible --name 'Selvage Studio' | tail -n 1)
xdotool windowfocus --sync "$window" key ctrl+q
ends
silent
