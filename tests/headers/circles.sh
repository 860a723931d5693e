#!/bin/sh
# circles.sh ROOT NM OBJECT...: refuses circles between files below ROOT: headers that include each other, and sources of
# which each uses what another of the circle defines, as the object files tell.
# circles.sh --self-test SCRATCH: proves that it refuses what it should.
set -eu
here=$(cd "$(dirname "$0")" && pwd)

# "A B NAME" for each NAME that A takes from B. Objects are called .../TARGET.dir/FILE.c.o.
from_objects() { # NM OBJECT...
    nm=$1
    shift
    "$nm" -A -P "$@" | awk '
        {
            file = $1
            sub(/:$/, "", file)
            if (file ~ /\/tools\/CMakeFiles\//) sub(/.*\.dir\//, "tools/", file)
            else sub(/.*\.dir\//, "", file)
            gsub(/\.\//, "", file)
            sub(/\.o$/, "", file)
        }
        $3 ~ /^[TDRBC]$/ { home[$2] = file }
        $3 == "U" { uses[++n] = file " " $2 }
        END {
            for (i = 1; i <= n; i++) {
                split(uses[i], use, " ")
                if (use[2] in home) print use[1], home[use[2]], use[2]
            }
        }'
}

# The same for headers that include one another; inner ones are found from runtime/, bake/ or tools/, or beside.
from_includes() { # ROOT
    (cd "$1" && find runtime bake tools assets tests -name '*.h' 2>/dev/null | sort | xargs awk '
        BEGIN { for (i = 1; i < ARGC; i++) exists[ARGV[i]] = 1 }
        /^[ \t]*#[ \t]*include[ \t]*[<"]/ {
            path = $0
            sub(/^[^<"]*[<"]/, "", path)
            sub(/[>"].*/, "", path)
            beside = FILENAME
            sub(/[^\/]*$/, "", beside)
            n = split(beside " runtime/ runtime/include/ bake/ bake/include/ tools/ tests/", roots, " ")
            for (i = 1; i <= n; i++)
                if ((roots[i] path) in exists) {
                    print FILENAME, roots[i] path, "include"
                    break
                }
        }' /dev/null)
}

judge() { # ORDER, edges on standard input
    awk -f "$here/circles.awk" "$1" -
}

if [ "$1" != --self-test ]; then
    root=$1
    shift
    { from_objects "$@"; from_includes "$root"; } | judge "$here/order.txt"
    exit
fi

scratch=$2
rm -rf "$scratch"
mkdir -p "$scratch/runtime/base"
failures=0
expect() { # accepted|refused WHAT, the verdict's own output in $scratch/output
    if judge "$scratch/order" <"$scratch/edges" >"$scratch/output"; then found=accepted; else found=refused; fi
    if [ "$found" != "$1" ]; then
        echo "$2: $found, but should be $1"
        cat "$scratch/output"
        failures=$((failures + 1))
    fi
}
: >"$scratch/order"
printf 'a.c b.c f\nb.c c.c g\na.c c.c g\n' >"$scratch/edges"
expect accepted "no circle"
printf 'a.c b.c f\nb.c c.c g\nc.c a.c h\n' >"$scratch/edges"
expect refused "a circle of three"
grep -q 'c.c needs a.c for h' "$scratch/output" || { echo "it does not say for what"; failures=$((failures + 1)); }
echo 'circle a.c b.c c.c d.c' >"$scratch/order"
expect accepted "a circle that is borne with"
echo 'circle a.c b.c' >"$scratch/order"
expect refused "a circle that has grown"
printf 'a.c b.c f\n' >"$scratch/edges"
expect accepted "a circle that is none any more"
grep -q 'strike it' "$scratch/output" || { echo "it does not say so"; failures=$((failures + 1)); }
: >"$scratch/order"
echo '#include "base/b.h"' >"$scratch/runtime/base/a.h"
echo '#include "a.h"' >"$scratch/runtime/base/b.h"
from_includes "$scratch" >"$scratch/edges"
expect refused "headers that include each other"
if command -v cc >/dev/null && command -v nm >/dev/null; then
    mkdir -p "$scratch/x.dir"
    echo 'int g(void); int f(void); int f(void) { return g(); }' >"$scratch/a.c"
    echo 'int g(void); int f(void); int g(void) { return f(); }' >"$scratch/b.c"
    for name in a b; do cc -c "$scratch/$name.c" -o "$scratch/x.dir/$name.c.o"; done
    from_objects nm "$scratch/x.dir/a.c.o" "$scratch/x.dir/b.c.o" >"$scratch/edges"
    expect refused "sources that use each other"
fi
exit $((failures != 0))
