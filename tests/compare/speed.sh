# The times of compare_builds.sh --speed; sourced by it. Both builds take turns of a few seconds, so that what else the
# shellcheck shell=bash disable=SC2154
# machine does falls on both alike, and the one that begins changes from turn to turn. Times are processor time; a rate
# is counted as the time that it means, so that more is slower in every row.

# Whether programs of both builds are there; said, if of one only.
both_have() { # program
    if [ -x "$old/bin/$1" ] && [ -x "$new/bin/$1" ]; then return 0; fi
    echo "  left out: $1 is not in both builds" >&2
    return 1
}

# Those of the options that the program of both builds knows by its usage text. An option with a value: --name=value.
known_options() { # program [--option | --option=value ...]
    local program=$1 option usage_old usage_new
    shift
    usage_old=$(of_build "$old" "$program" --help 2>&1 || true)
    usage_new=$(of_build "$new" "$program" --help 2>&1 || true)
    for option; do
        if [[ $usage_old == *"${option%%=*}"* && $usage_new == *"${option%%=*}"* ]]; then
            tr '=' ' ' <<<"$option"
        else
            echo "  $program: ${option%%=*} is not known to both builds and left out" >&2
        fi
    done | tr '\n' ' '
}

# A row of one round: what, and its time in any unit.
timed() { # side
    awk -F '\t' -v side="$1" -v OFS='\t' '$2 > 0 { print $1, side, $2 }' >>"$work/times"
}

preloaded() { # BUILD program [arguments]
    if [ -n "$clock" ]; then LD_PRELOAD=$clock of_build "$@"; else of_build "$@"; fi
}

time_frames() { # BUILD side anisotropy
    # shellcheck disable=SC2086
    preloaded "$1" bench_strategies "$work/in/demo" $frame_options $3 | awk -v aniso="$3" '
        /"anisotropy":/ { match($0, /"anisotropy": [0-9]+/); aniso = substr($0, RSTART + 14, RLENGTH - 14) }
        match($0, /"[a-z-]+": {"median_ms": [0-9.]+/) {
            split(substr($0, RSTART, RLENGTH), part, /[": {,]+/)
            print "frame " part[2] ", anisotropy " aniso "\t" part[4]
        }' | timed "$2"
}

# Lookups are already counted by processor time. A row is the geometric mean of footprints and patterns; of three runs the
# middle one, for in the first the memory of a cache is touched for the first time.
time_filter() { # BUILD side filter
    # shellcheck disable=SC2086
    of_build "$1" bench_filter $filter_options --filter "$3" | awk -F '[:,{}"]+' -v OFS='\t' '
        { for (i = 2; i < NF; i += 2) value[$i] = $(i + 1)
          for (m = 1; m <= split("one batch sorted", modes, " "); m++)
              if (value[modes[m]] > 0) { sum[m] -= log(value[modes[m]]); n[m]++ } }
        END { for (m in n) print "lookup " value["filter"] ", " modes[m], exp(sum[m] / n[m]) }' | sort | timed "$2"
}

time_ptx() { # BUILD side
    # shellcheck disable=SC2086
    preloaded "$1" bench_ptx $ptx_options | awk -F '"' -v OFS='\t' '
        { value = $0; sub(/.*"value": /, "", value); value += 0
          if ($8 == "MB/s" && value > 0) print ".ptx " $4, 1 / value
          if ($8 == "ms") print ".ptx " $4, value }' | timed "$2"
}

# The whole of a command, from start to end.
time_command() { # BUILD side what arguments
    local build=$1 side=$2 what=$3 TIMEFORMAT='%3U %3S'
    shift 3
    {
        time of_build "$build" selvage "$@" >/dev/null 2>&1
    } 2>"$work/time" || true
    awk -v what="command $what" -v OFS='\t' '{ print what, $1 + $2 }' "$work/time" | timed "$side"
}

both() { # function arguments
    local what=$1
    shift
    if ((turn++ % 2)); then
        "$what" "$new" new "$@"
        "$what" "$old" old "$@"
    else
        "$what" "$old" old "$@"
        "$what" "$new" new "$@"
    fi
}

one_round() {
    local demo=$work/in/demo aniso filter
    for aniso in "${anisotropies[@]}"; do both time_frames "$aniso"; done
    for filter in "${timed_filters[@]}"; do both time_filter "$filter"; done
    if [ "$files" = 1 ]; then both time_ptx; fi
    both time_command convert convert "$demo/scene.ptx" "$work/timed.ptx" --type half
    both time_command merge merge "$demo/scene.ptx" "$demo/scene_faces.ptx" -o "$work/timed.ptx"
    both time_command check check "$demo/scene.ptx"
    both time_command diff diff "$demo/scene.ptx" "$demo/scene_faces.ptx"
    both time_command transfer transfer "$work/timed-small.ptx" "$work/timed.ptx" --to "$demo/scene.obj" --no-copies
    both time_command sample sample "$demo/scene.ptx" --queries "$work/timed-queries.txt"
    both time_command reference reference "$demo/scene.ptx" --samples 64 --size 160x120 --out "$work/timed.exr"
}

print_times() {
    awk -F '\t' -f "$here/times.awk" "$work/times"
}

# What the rounds need; made by the old build.
prepare_times() {
    clock=$work/cpu_clock.so
    if ! "${CC:-cc}" -O2 -shared -fPIC -o "$clock" "$here/cpu_clock.c" -ldl 2>"$work/why"; then
        echo "  times of frames and files are by the clock: ${CC:-cc} does not compile cpu_clock.c" >&2
        clock=
    fi
    of_build "$old" selvage convert "$work/in/demo/scene.ptx" "$work/timed-small.ptx" --scale 1/8 >/dev/null
    awk -v filters="$(filters_of "$old" | tr '\n' ' ')" -v faces=2000 -v channels=3 -v seed=11 -v count=4000 \
        -f "$here/queries.awk" >"$work/timed-queries.txt"
    anisotropies=() timed_filters=() files=0 turn=0
    if both_have bench_strategies; then
        frame_options=$(known_options bench_strategies --json "--frames=$((quick ? 2 : 4))" --msaa=4)
        anisotropies=("--aniso 1" "--aniso 16")
        if [ -z "$(known_options bench_strategies --aniso)" ]; then anisotropies=(""); fi
    fi
    if both_have bench_filter; then
        mapfile -t timed_filters < <(comm -12 <(filters_of "$old" | sort) <(filters_of "$new" | sort))
        filter_options=$(known_options bench_filter --json --faces=1024 --runs=3 "--seconds=$((quick ? 5 : 15))e-3")
    fi
    if both_have bench_ptx; then
        files=1
        ptx_options=$(known_options bench_ptx --json --faces=512 --runs=3)
    fi
}

time_builds() {
    local round
    prepare_times
    : >"$work/times"
    # As many threads as the driver likes: the sum of their time is what is measured.
    unset LP_NUM_THREADS
    for ((round = 1; round <= rounds; round++)); do one_round; done
    print_times
}
