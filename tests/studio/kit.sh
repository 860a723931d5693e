# What tests of the studio share: a display of their own, a window on it, and real events of keyboard and pointer. Nothing
# waits for a time: only for lines of the studio's log. Sourced with the folder of the programs as $1.
set -eu

bin=$1
here=$(mktemp -d /tmp/selvage-studio-XXXXXX)
# shaders that are compiled already may be used again
export MESA_SHADER_CACHE_DIR="${MESA_SHADER_CACHE_DIR:-${XDG_CACHE_HOME:-$HOME/.cache}}"
export HOME=$here XDG_STATE_HOME=$here/state XDG_CONFIG_HOME=$here/config XDG_CACHE_HOME=$here/cache
export XDG_RUNTIME_DIR=$here/run LC_ALL=C GALLIVM_PERF=nopt
export LP_NUM_THREADS=1
unset DBUS_SESSION_BUS_ADDRESS WAYLAND_DISPLAY GTK_A11Y
mkdir -m 700 "$here/run"
log=$here/log
err=$here/err
server=
studio=
keeper=

finish() {
    code=$?
    if [ $code != 0 ]; then
        [ -z "${SELVAGE_STUDIO_SHOT:-}" ] || import -window root "$SELVAGE_STUDIO_SHOT" || true
        tail -n 12 "$log" 2>/dev/null || true
        cat "$err" 2>/dev/null || true
    fi
    [ -z "$studio" ] || kill -9 "$studio" 2>/dev/null || true
    [ -z "$keeper" ] || kill "$keeper" 2>/dev/null || true
    [ -z "$server" ] || kill "$server" 2>/dev/null || true
    rm -rf "$here"
    exit $code
}
trap finish EXIT
fail() { echo "failed: $*"; exit 1; }

start_display() { # WIDTHxHEIGHT
    mkfifo "$here/number"
    Xvfb -displayfd 3 -screen 0 "${1:-1300x800}x24" -nolisten tcp 3>"$here/number" 2>"$here/server" &
    server=$!
    read -r number <"$here/number"
    export DISPLAY=":$number"
}

# Until so many lines (1) of the log have the words.
wait_for() { # WORDS [COUNT]
    tries=0
    while [ "$(grep -c -- "$1" "$log" 2>/dev/null || true)" -lt "${2:-1}" ]; do
        kill -0 "$studio" 2>/dev/null || fail "the studio has ended while '$1' was waited for"
        tries=$((tries + 1))
        [ $tries -lt 1200 ] || fail "waited in vain for '$1' (${2:-1})"
        sleep 0.05
    done
}
count_of() { grep -c -- "$1" "$log" || true; }
# One more of them than there are now, after the events that xdotool makes of the rest.
does() { # WORDS XDOTOOL-ARGUMENTS...
    words=$1
    shift
    wanted=$(($(count_of "$words") + 1))
    xdotool "$@"
    wait_for "$words" $wanted
}
key() { # ACTION KEY: presses it, and waits for the action's end
    does "\"event\":\"done\",\"name\":\"$1\"" key "$2"
}
refined() { wait_for '"refined":true' $(($(count_of '"refined":true') + 1)); }

field() { # NAME [WIDGET]: of the last line of the area, or of another part of the window
    grep "\"event\":\"${2:-area}\"" "$log" | tail -n 1 | sed "s/.*\"$1\":\([-0-9.]*\).*/\1/"
}

start_studio() { # ARGUMENTS...
    : >"$log"
    "$bin/selvage" studio --log "$log" "$@" >>"$err" 2>&1 &
    studio=$!
    wait_for '"event":"window"'
}
# After the first picture: where the area is, and the keyboard's focus.
take_window() {
    wait_for '"refined":true'
    window=$(xdotool search --onlyvisible --name 'Selvage Studio' | tail -n 1)
    xdotool windowfocus --sync "$window"
    left=$(field x) top=$(field y) width=$(field width) height=$(field height)
    middle_x=$((left + width / 2)) middle_y=$((top + height / 2))
}
# From a place to another, relative to the middle, in steps that the pointer makes one by one.
drag() { # WORDS BUTTON X Y DX DY STEPS
    steps=""
    for i in $(seq "$7"); do steps="$steps mousemove_relative -- $5 $6"; done
    # shellcheck disable=SC2086
    does "$1" mousemove $((middle_x + $3)) $((middle_y + $4)) mousedown "$2" $steps mouseup "$2"
}
# The window beside the studio's own; empty: there is none.
other_window() {
    xdotool search --onlyvisible --class selvage-studio 2>/dev/null | grep -v "^$window\$" | tail -n 1 || true
}
# In a file chooser's field: the path, and Enter. A chooser takes keys from some moment on that nobody tells, so that what it
# has not taken is typed again.
choose() { # WORDS PATH
    wanted=$(($(count_of "$1") + 1))
    tries=0
    while [ "$(count_of "$1")" -lt $wanted ]; do
        tries=$((tries + 1))
        [ $tries -lt 1200 ] || fail "the file chooser has not brought '$1'"
        chooser=$(other_window)
        if [ -n "$chooser" ] && [ $((tries % 100)) = 10 ]; then
            xdotool windowfocus "$chooser" key ctrl+a type --delay 10 "$2"
            xdotool key Return
        fi
        sleep 0.05
    done
    xdotool windowfocus --sync "$window" 2>/dev/null || true
}
# Presses a key in a question until it has been answered, with the answer of that number.
answer() { # KEY NUMBER
    wanted=$(($(count_of '"event":"answer"') + 1))
    tries=0
    while [ "$(count_of '"event":"answer"')" -lt $wanted ]; do
        tries=$((tries + 1))
        [ $tries -lt 1200 ] || fail "the question has not been answered"
        question=$(other_window)
        if [ -n "$question" ] && [ $((tries % 100)) = 10 ]; then
            xdotool windowfocus "$question" key "$1" || true
        fi
        sleep 0.05
    done
    grep '"event":"answer"' "$log" | tail -n 1 | grep -q "\"answer\":$2}" || fail "the answer was not $2"
    xdotool windowfocus "$window" 2>/dev/null || true
}
# Types a number into a question until it has been answered.
answer_with() { # NUMBER
    wanted=$(($(count_of '"event":"answer"') + 1))
    tries=0
    while [ "$(count_of '"event":"answer"')" -lt $wanted ]; do
        tries=$((tries + 1))
        [ $tries -lt 1200 ] || fail "the number has not been taken"
        question=$(other_window)
        if [ -n "$question" ] && [ $((tries % 100)) = 10 ]; then
            xdotool windowfocus "$question" key ctrl+a type --delay 10 "$1" || true
            xdotool key Return
        fi
        sleep 0.05
    done
    grep '"event":"answer"' "$log" | tail -n 1 | grep -q "\"answer\":$1}" || fail "the answer was not $1"
}
ends() { # waits for the end of the studio
    wait "$studio" || fail "the studio has ended with $?"
    studio=
}
silent() { [ ! -s "$err" ] || fail "something was printed on the terminal"; }
