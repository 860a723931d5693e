#!/bin/bash
# Compares what two builds of Selvage write, print and return, and how long they take: proof that a change of the code
# was none of what it does. See usage below.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)

usage() {
    cat <<'TEXT'
compare_builds.sh - say whether two builds of Selvage do the same, bit for bit, and as fast

Usage: compare_builds.sh OLD_BUILD NEW_BUILD [options]
       compare_builds.sh --self-test [BUILD]

OLD_BUILD and NEW_BUILD are build folders, with bin/selvage and bin/selvage-assets in them; they may be of different
commits. Every command line is run by both builds, in two folders with the same files in them. What is written is
compared byte by byte, and so are standard output, standard error and exit codes.

Options:
  --quick          fewer files, smaller pictures, fewer lookups (about a minute)
  --groups LIST    these groups only, comma-separated; see below
  --no-compare     no comparison; for --speed alone
  --speed          also time both builds, in turns, and print the ratio new/old
  --rounds N       turns of --speed (5, with --quick 3)
  --jobs N         commands at a time (one per processor)
  --data FOLDER    .ptx files to work on (tests/conformance/data)
  --keep FOLDER    leave there what differs; the folder must be empty or new
  --self-test      prove that differences are found, with commands made for the purpose; with BUILD, also with
                   a build of which a file and a picture are spoilt
  --help           this text

Groups, besides `lists` (strategies, filters) and `assets` (the demo scene), which there always are:
  help         help texts, and command lines that make no sense
  info         info, check and diff as text and as JSON, also of damaged files
  convert      types, sizes, channels and options of convert
  images       convert to folders and sheets and back, and info --sheet
  edit         merge, transfer, check --repair, diff --images
  faces        pick, split, convert --faces, passes of numbers, --salvage
  sample       lookups with every filter
  pictures     every strategy with anisotropy 1 and 16, and from compressed textures
  reference    ray-cast pictures and their errors
  report       what compare writes, but for its times

Environment:
  SELVAGE_SAMPLES      a folder of folders with .ptx files and OBJ files of the same name; used if set
  SELVAGE_CONFORMANCE  more .ptx files; used if set, but not with --quick

Inputs are made by the old build and given to both, so a difference is listed where it arises. What is known to change
from run to run is masked: seconds and rates of reference, times, ratios of times and what is concluded from them in
compare's report, the version. Of report.html, table1.md, table1.tex and frames.jsonl, in which times are everywhere,
nothing is compared. A command that fails alike in both builds counts as equal, and is counted; a group in which none
succeeds is an error.

Times are processor time (user and system, all threads). They never change the exit code; a row beyond 5 % is marked.

Exit codes: 0 all equal, 1 something differs, 2 wrong usage, or the comparison could not be made.
TEXT
}

die() {
    echo "compare_builds.sh: $*" >&2
    exit 2
}

parse_arguments() {
    quick=0 speed=0 compare=1 rounds="" jobs=$(nproc) groups="" keep="" data=$root/tests/conformance/data
    local builds=()
    while [ $# -gt 0 ]; do
        case $1 in
        --quick) quick=1 ;;
        --speed) speed=1 ;;
        --no-compare) compare=0 ;;
        --groups | --rounds | --jobs | --data | --keep)
            [ $# -gt 1 ] || die "$1 wants a value (see --help)"
            declare -g "${1#--}=$2"
            shift
            ;;
        -*) die "unknown option $1 (see --help)" ;;
        *) builds+=("$1") ;;
        esac
        shift
    done
    [ ${#builds[@]} = 2 ] || die "two builds are wanted (see --help)"
    : "${rounds:=$((quick ? 3 : 5))}"
    [[ $rounds =~ ^[1-9][0-9]*$ && $jobs =~ ^[1-9][0-9]*$ ]] || die "--rounds and --jobs want a number"
    local side
    for side in 0 1; do
        local bin=${builds[$side]}/bin
        [ -x "$bin/selvage" ] && [ -x "$bin/selvage-assets" ] ||
            die "${builds[$side]} is no build: bin/selvage and bin/selvage-assets are not there"
    done
    old=$(cd "${builds[0]}" && pwd) new=$(cd "${builds[1]}" && pwd)
    ls "$data"/*.ptx >/dev/null 2>&1 || die "$data: no .ptx files"
    data=$(cd "$data" && pwd)
    if [ -n "$keep" ]; then
        mkdir -p "$keep"
        [ -z "$(ls -A "$keep")" ] || die "$keep is not empty"
        keep=$(cd "$keep" && pwd)
    fi
}

# Runs a program of a build with that build's libraries, wherever the build was made.
of_build() { # BUILD PROGRAM [arguments]
    local build=$1 program=$2
    shift 2
    PATH=$build/bin:$PATH LD_LIBRARY_PATH=$build/lib "$build/bin/$program" "$@"
}

strategies_of() {
    of_build "$1" selvage render --help | sed -n 's/^ *--strategy WORD .*[ :]\([a-z|-]*\)$/\1/p' | tr '|' '\n'
}

filters_of() {
    of_build "$1" selvage sample --help | tr '\n' ' ' | sed -n 's/.*FILTER is \([a-z, ]*\)\..*/\1/p' |
        sed 's/ or / /; s/,/ /g' | tr -s ' ' '\n'
}

# Notes a result as run_case.sh does.
note() { # ID group same|differ name [what differs]
    printf '%s\t%s\t%s\t%s\t%s\n' "$2" "$3" 0 "$4" "$1" >"$work/results/$1"
    if [ $# -gt 4 ]; then printf '%s\n' "$5" >"$work/results/$1.why"; fi
}

results_of() { # group
    (cd "$work/results" && find . -type f ! -name '*.why' | sort -V | xargs -r cat) |
        awk -F '\t' -v group="$1" '$1 == group'
}

# Names that both builds list; those that only one has are differences.
in_both() { # what lister
    local what=$1 lister=$2 only
    "$lister" "$old" >"$work/$what.old" || true
    "$lister" "$new" >"$work/$what.new" || true
    [ -s "$work/$what.old" ] || die "the old build lists no $what"
    sort "$work/$what.old" >"$work/a"
    sort "$work/$what.new" >"$work/b"
    only=$(comm -3 "$work/a" "$work/b" | tr -d '\t' | tr '\n' ' ')
    if [ -n "$only" ]; then
        note "list-$what" lists differ "$what" "only in one build: $only"
    else
        note "list-$what" lists same "$what"
    fi
    grep -Fxf "$work/b" "$work/$what.old" || die "the builds have no $what in common"
}

# The scene as both builds make it; what follows uses that of the old one.
make_scene() {
    local file
    of_build "$old" selvage-assets "$work/in/demo" >"$work/assets.old" || die "the old build makes no demo scene"
    of_build "$new" selvage-assets "$work/new-demo" >"$work/assets.new" || true
    for file in scene.obj scene.ptx scene_faces.ptx; do
        if cmp "$work/in/demo/$file" "$work/new-demo/$file" >"$work/why" 2>&1; then
            note "assets-$file" assets same "$file"
        else
            note "assets-$file" assets differ "$file" "$(sed "s|$work/||g" "$work/why")"
        fi
    done
    rm -rf "$work/new-demo"
}

# One line for a group; then a line for each difference, and what it is.
summarize() { # group
    results_of "$1" | awk -F '\t' -v group="$1" -v folder="$work/results/" '
        { n++; failed += $3 }
        $2 == "differ" {
            differ++
            list = list "  differs: " $4 "\n"
            while ((getline line < (folder $5 ".why")) > 0) list = list "           " line "\n"
        }
        END {
            if (n) printf "%-10s %5d compared, %d differ%s\n%s", group, n, differ,
                          failed ? " (" failed " fail alike)" : "", list
        }'
}

# A group in which nothing works proves nothing, and neither do cases that never ended.
refuse_vacuous() { # group
    local worked
    worked=$(results_of "$1" | awk -F '\t' '{ n++; good += $2 == "differ" || !$3 }
        END { print n && !good ? "no" : "yes" }')
    if [ "$worked" = no ]; then
        echo "  no command of this group succeeds in either build, so nothing was compared"
        vacuous=1
    fi
    if [ "$(results_of "$1" | wc -l)" != "$(grep -c "^$1	" "$work/cases" || true)" ]; then
        echo "  not all commands of this group came to an end"
        vacuous=1
    fi
}

wanted() { [ -z "$groups" ] || [[ ,$groups, == *,$1,* ]]; }

compare_all() {
    local group all="help info convert images edit faces sample pictures reference report"
    for group in ${groups//,/ }; do
        [[ " $all " == *" $group "* ]] || die "no group $group (see --help)"
    done
    strategies=$(in_both strategies strategies_of) || exit 2
    filters=$(in_both filters filters_of) || exit 2
    summarize lists
    summarize assets
    make_inputs
    list_cases >"$work/cases"
    for group in $all; do
        wanted "$group" || continue
        awk -F '\t' -v g="$group" '$1 == g { print NR }' "$work/cases" |
            xargs -r -P "$jobs" -n 8 timeout 900 bash "$here/run_case.sh" || true
        summarize "$group"
        refuse_vacuous "$group"
    done
}

finish() {
    local compared differ
    if [ "$compare" = 1 ]; then
        compared=$(find "$work/results" -type f ! -name '*.why' | wc -l)
        differ=$(find "$work/results" -name '*.why' | wc -l)
        if [ -n "$keep" ] && [ -d "$work/differ" ]; then cp -rP "$work/differ/." "$keep"; fi
        echo "$compared compared, $differ differ"
        if [ "$vacuous" = 1 ]; then exit 2; fi
        if [ "$differ" -gt 0 ]; then exit 1; fi
    fi
}

case ${1:-} in
--help)
    usage
    exit 0
    ;;
--self-test)
    shift
    exec bash "$here/self_test.sh" "$@"
    ;;
esac
parse_arguments "$@"
vacuous=0
work=$(mktemp -d "${TMPDIR:-/tmp}/selvage-compare-XXXXXX")
trap 'rm -rf "$work"' EXIT
trap 'exit 2' INT TERM
mkdir -p "$work/in" "$work/results"
# Pictures that are drawn side by side need no threads of the driver's; shaders from elsewhere would hide the builds'.
export LP_NUM_THREADS="${LP_NUM_THREADS:-1}" MESA_SHADER_CACHE_DIR="$work/cache"
unset SELVAGE_SHADER_DIR
export COMPARE_OLD=$old COMPARE_NEW=$new COMPARE_WORK=$work COMPARE_KEEP=$keep
source "$here/cases.sh"
source "$here/speed.sh"
make_scene
if [ "$compare" = 1 ]; then compare_all; fi
if [ "$speed" = 1 ]; then time_builds; fi
finish
