#!/bin/sh
# Writes what `selvage help --table` says into verbs-options.md; with --check only says whether it is there.
#   docs/verbs_table.sh [--check] build/bin/selvage
set -eu
check=false
if [ "${1-}" = --check ]; then
    check=true
    shift
fi
if [ $# -ne 1 ]; then
    echo "usage: $0 [--check] build/bin/selvage" >&2
    exit 2
fi
page=$(dirname "$0")/verbs-options.md
made=$(mktemp)
trap 'rm -f "$made" "$made.table"' EXIT
"$1" help --table >"$made.table"
awk -v table="$made.table" '
    /^<!-- end of the table -->$/ { inside = 0 }
    !inside { print }
    /^<!-- table -->$/ {
        inside = 1
        while ((getline line < table) > 0) print line
    }' "$page" >"$made"
# one letter, one option (-o is the output, however else a verb calls it; --strategies are several of --strategy)
letters=$(awk -F'[`]' '/^\| `--/ {
    name = $2 == "--strategies" ? "--strategy" : $2
    for (i = 4; i < NF; i += 2)
        if ($i ~ /^-[a-np-z]$/) {
            if ($i in means && means[$i] != name) print $i ": " means[$i] " and " name
            means[$i] = name
        }
}' "$made.table" | sort -u)
if [ "$letters" ]; then
    echo "$letters" >&2
    echo "a letter means one option in all verbs" >&2
    exit 1
fi
if ! $check; then
    cat "$made" >"$page"
elif ! cmp -s "$made" "$page"; then
    diff "$page" "$made" | head -20 >&2 || true
    echo "docs/verbs-options.md is not what the command says: docs/verbs_table.sh $1 writes it" >&2
    exit 1
fi
