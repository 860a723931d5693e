#!/bin/sh
# sweep.sh ROOT: fails if a public function that returns a result is not SLV_NODISCARD, or is called by none of the files
# whose calls run out of memory one allocation at a time. sweep.sh --self-test FOLDER: whether it would find one.
set -eu

# Files of such calls, and what cannot be among them: a name and why. Whoever adds a function adds a call of it to one of
# these files (tests/kit/calls_kit.h has the table of those of libselvage and libselvage-bake).
swept='tests/kit/calls_*.h tests/render/*out_of_memory*.c'
excepted='
slv_cache_prefetch reads in the background, and nobody is told what fails there
'

# The functions that headers declare: a name, and nodiscard or plain.
declared() {
    cat "$@" | awk '
        { text = text " " $0 }
        END {
            gsub(/\/\*([^*]|\*+[^*\/])*\*+\//, " ", text)
            count = split(text, parts, /[;{}]/)
            for (i = 1; i <= count; i++)
                if (parts[i] ~ /SLV_API/ && match(parts[i], /slv_result +slv_[a-z0-9_]+ *\(/)) {
                    name = substr(parts[i], RSTART, RLENGTH)
                    sub(/slv_result +/, "", name)
                    sub(/ *\(/, "", name)
                    print name, parts[i] ~ /SLV_NODISCARD/ ? "nodiscard" : "plain"
                }
        }'
}

check() {
    root=$1
    status=0
    calls=$(for pattern in $swept; do
        for file in "$root"/$pattern; do
            [ -e "$file" ] && cat "$file"
        done
    done)
    list=$(declared "$root"/runtime/include/selvage/*.h "$root"/bake/include/selvage/*.h)
    [ "$list" ] || { echo "no functions found"; return 1; }
    while read -r name kind; do
        if [ "$kind" = plain ]; then
            echo "$name returns a result and is not SLV_NODISCARD"
            status=1
        fi
        case "$excepted" in *"
$name "*) continue ;; esac
        # called itself, or handed to what calls it
        if ! printf '%s\n' "$calls" | grep -q "\b$name\b[(),]"; then
            echo "$name is in no sweep of failing allocations: add a call to tests/kit/calls_*.h"
            status=1
        fi
    done <<END
$list
END
    # of what is excepted nothing may be forgotten here
    for name in $(printf '%s\n' "$excepted" | awk 'NF { print $1 }'); do
        printf '%s\n' "$list" | grep -q "^$name " || { echo "$name is excepted and not there"; status=1; }
    done
    return $status
}

if [ "$1" = --self-test ]; then
    folder=$2
    rm -rf "$folder"
    mkdir -p "$folder/runtime/include/selvage" "$folder/bake/include/selvage" "$folder/tests/kit"
    header="$folder/runtime/include/selvage/one.h"
    echo 'SLV_NODISCARD SLV_API slv_result slv_one(int a);' >"$folder/bake/include/selvage/two.h"
    printf '/* slv_result slv_no(void); */\nSLV_NODISCARD SLV_API slv_result\nslv_cache_prefetch(int a,\n int b);\n' >"$header"
    printf 'r = slv_one(1);\n' >"$folder/tests/kit/calls_kit.h"
    check "$folder" || { echo "refuses what is right"; exit 1; }
    echo 'SLV_NODISCARD SLV_API slv_result slv_one_more(int a);' >>"$header"
    check "$folder" >"$folder/said" && { echo "takes a call that is not swept"; exit 1; }
    grep -q 'slv_one_more is in no sweep' "$folder/said" || exit 1
    printf 'r = slv_one_more(1);\n' >>"$folder/tests/kit/calls_kit.h"
    check "$folder" || exit 1
    echo 'SLV_API slv_result slv_one(int a);' >>"$header"
    check "$folder" >"$folder/said" && { echo "takes a result that may be dropped"; exit 1; }
    grep -q 'slv_one returns a result' "$folder/said" || exit 1
    exit 0
fi
check "$1"
