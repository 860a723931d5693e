#!/bin/bash
# run_case.sh ID ...: runs cases of compare_builds.sh with both builds, and notes for each whether they did the same.
# A case is the line ID of the list of cases: group, name, and what to run in an empty folder; ` in/` is replaced by the
# way to the inputs. COMPARE_OLD, COMPARE_NEW and COMPARE_WORK say where the builds and the list are. There are
# thousands of short commands, so nothing is started for them that can be done without.
set -u
export LC_ALL=C

# What the cases call. Exit codes become a part of the output.
t() {
    selvage "$@"
    echo "exit $?"
}

# Times in the files that compare writes: four are full of them, the others have them in fields of their own.
mask_report() { # FOLDER
    [ -d "$1" ] || return 0
    rm -f "$1/report.html" "$1/table1.md" "$1/table1.tex" "$1/frames.jsonl"
    awk -F, -v OFS=, '{ $4 = $5 = $6 = $7 = $8 = "TIME" } 1' "$1/table1.csv" >"$1/table1.masked"
    awk '/"claim"/ { timed = /quicker/ }
         /"(judgement|numbers)"/ && timed { sub(/": .*/, "\": TIME") }
         /"(advice|version)"/ { sub(/": .*/, "\": MASKED") }
         /"([a-z_]*_ms|[a-z_]*ratio|seconds)"/ { sub(/": .*/, "\": TIME") } 1' \
        "$1/report.json" >"$1/report.masked"
    rm -f "$1/table1.csv" "$1/report.json"
}

# A picture's convergence: the second column is seconds.
mask_convergence() { # FOLDER
    [ -f "$1/convergence.csv" ] || return 0
    awk -F, -v OFS=, '{ $2 = "TIME" } 1' "$1/convergence.csv" >"$1/convergence.masked"
    rm "$1/convergence.csv"
}

run_side() { # BUILD FOLDER COMMANDS
    cd "$2" || exit 2
    PATH=$1/bin:$path LD_LIBRARY_PATH=$1/lib
    eval "$3" >standard-output 2>standard-error </dev/null
    cd .. || exit 2
    PATH=$path
    unset LD_LIBRARY_PATH
}

# Times and versions in what was printed, and where the build is.
mask() { # BUILD FOLDER
    sed -E -i \
        -e 's/"(seconds|million_samples_per_second)": [^,}]*/"\1": TIME/g' \
        -e 's/[0-9.]+ s, [0-9.]+ million samples a second/TIME/' \
        -e 's/^selvage [0-9]+\.[0-9]+\.[0-9]+.*/selvage VERSION/' \
        -e 's/^[^ ]*run_case.sh: line [0-9]+: +[0-9]+ /PROCESS /' \
        -e "s|$1|BUILD|g" "$2/standard-output" "$2/standard-error"
}

same() { # OLD NEW
    diff -rq "$1" "$2" >/dev/null && return
    mask "$COMPARE_OLD" "$1"
    mask "$COMPARE_NEW" "$2"
    diff -rq "$1" "$2" >/dev/null
}

# Whether commands failed and none succeeded.
all_failed() { # FOLDER
    local output="" newline=$'\n'
    IFS= read -r -d '' output <"$1/standard-output"
    output=$newline$output
    [[ $output = *"${newline}exit "[1-9]* && $output != *"${newline}exit 0$newline"* ]]
}

# What differs, in a few lines.
explain() { # COMMANDS
    diff -rq old new | head -n 6
    local file
    for file in standard-output standard-error; do
        cmp -s "old/$file" "new/$file" || diff -a "old/$file" "new/$file" | cut -c 1-160 | head -n 4
    done
    mkdir again
    run_side "$COMPARE_OLD" again "$1"
    mask "$COMPARE_OLD" again
    diff -rq old again >/dev/null || echo "the old build differs from itself, too, when run again"
    echo "run: $1"
}

one_case() { # ID
    local id=$1 group name commands verdict=same failed=0 written
    IFS=$'\t' read -r group name commands <<<"${cases[id - 1]}"
    commands=${commands// in\// ../in/}
    run_side "$COMPARE_OLD" old "$commands"
    run_side "$COMPARE_NEW" new "$commands"
    if all_failed old; then failed=1; fi
    if ! same old new; then
        verdict=differ
        explain "$commands" >"$COMPARE_WORK/results/$id.why"
        if [ -n "$COMPARE_KEEP" ]; then
            mkdir -p "$COMPARE_WORK/differ/$id"
            cp -r old new "$COMPARE_WORK/differ/$id"
            cp "$COMPARE_WORK/results/$id.why" "$COMPARE_WORK/differ/$id/why"
        fi
        rm -rf again
    fi
    printf '%s\t%s\t%s\t%s\t%s\n' "$group" "$verdict" "$failed" "$name" "$id" >"$COMPARE_WORK/results/$id"
    written=(old/* new/*)
    rm -rf "${written[@]}"
}

path=$PATH
mapfile -t cases <"$COMPARE_WORK/cases"
mkdir -p "$COMPARE_WORK/run/$$"/{old,new}
cd "$COMPARE_WORK/run/$$" || exit 2
ln -s "$COMPARE_WORK/in" in
for id; do one_case "$id"; done
exit 0
