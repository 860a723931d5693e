#!/bin/sh
# names.sh ROOT: fails if an enumeration of the public headers has no function for its words, or one that unit.names does not
# ask for each value. names.sh --self-test FOLDER: whether it would find one.
set -eu

# Enumerations whose words are no names: a type and why.
excepted='
slv_result has phrases: slv_result_string
'

check() {
    root=$1
    status=0
    text=$(cat "$root"/runtime/include/selvage/*.h "$root"/bake/include/selvage/*.h | tr '\n' ' ' | tr -s ' ')
    types=$(printf '%s' "$text" | grep -oE 'typedef enum[^{]*\{[^}]*\} *slv_[a-z0-9_]+;' | sed -E 's/.*\} *//; s/;//')
    [ "$types" ] || { echo "no enumerations found"; return 1; }
    for type in $types; do
        case "$excepted" in *"
$type "*) continue ;; esac
        if ! printf '%s' "$text" | grep -qE "const char \* ?${type}_name\("; then
            echo "$type has no ${type}_name"
            status=1
        fi
        if ! grep -q "CHECK_NAMES($type," "$root/tests/unit/names.c"; then
            echo "$type is not among the CHECK_NAMES of tests/unit/names.c"
            status=1
        fi
    done
    for type in $(printf '%s\n' "$excepted" | awk 'NF { print $1 }'); do
        printf '%s\n' "$types" | grep -qx "$type" || { echo "$type is excepted and not there"; status=1; }
    done
    return $status
}

if [ "$1" = --self-test ]; then
    folder=$2
    rm -rf "$folder"
    mkdir -p "$folder/runtime/include/selvage" "$folder/bake/include/selvage" "$folder/tests/unit"
    header="$folder/runtime/include/selvage/one.h"
    echo 'typedef enum slv_result { SLV_OK } slv_result;' >"$folder/bake/include/selvage/two.h"
    printf 'typedef enum slv_one {\n    SLV_ONE = 0, /* 1; */\n    SLV_TWO\n} slv_one;\nSLV_API const char *slv_one_name(slv_one o);\n' \
        >"$header"
    echo 'CHECK_NAMES(slv_one, SLV_TWO, slv_one_name, true);' >"$folder/tests/unit/names.c"
    check "$folder" || { echo "refuses what is right"; exit 1; }
    echo 'typedef enum { SLV_THREE } slv_more;' >>"$header"
    check "$folder" >"$folder/said" && { echo "takes an enumeration without words"; exit 1; }
    grep -q 'slv_more has no slv_more_name' "$folder/said" || exit 1
    grep -q 'slv_more is not among' "$folder/said" || exit 1
    exit 0
fi
check "$1"
