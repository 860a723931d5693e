#!/bin/sh
# sizes.sh ROOT: no hand-written file below ROOT is longer than 600 lines, none begins without a comment that says what it is
# for, and no function has more than 80 lines or 8 parameters unless the comment directly above says why, in a
# sentence with the word "lines" or "parameters" and "because", "since", "so that" or "which". Takes universal-ctags.
# sizes.sh --self-test SCRATCH: proves that it refuses what it should.
set -eu

sources() {
    find runtime bake tools assets tests shaders docs \( -name scratch -o -path tests/fuzz/corpus \) -prune -o -type f \
        \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.glsl' -o -name '*.vert' -o -name '*.frag' \
        -o -name '*.comp' -o -name '*.cmake' -o -name 'CMakeLists.txt' -o -name '*.sh' -o -name '*.awk' -o -name '*.js' \
        -o -name '*.css' \) -print 2>/dev/null | sort
}

files() {
    sources | xargs awk '
        function finish() {
            if (last != "" && lines > 600) { print last ": " lines " lines, more than 600" }
        }
        FNR == 1 { finish(); last = FILENAME; opened = 0 }
        { lines = FNR }
        !opened && /[^ \t]/ && !/^#!/ && !/^#version/ {
            opened = 1
            words = split($0, parts, /[ \t]+/)
            if (FILENAME ~ /\.(sh|awk|cmake|txt)$/ ? $0 !~ /^# / : $0 !~ /^(\/\*|\/\/)/) {
                print FILENAME ":" FNR ": the file does not begin with a comment that says what it is for"
            } else if (words < 4) {
                print FILENAME ":" FNR ": the first line of the file says too little of what it is for"
            }
        }
        END { finish() }'
}

functions() {
    sources | grep -E '\.(c|h|cpp)$' |
        ctags --languages=C,C++ --map-C=+.h --map-C++=-.h --kinds-C=f --kinds-C++=f --fields=neS --sort=no -L - -f - 2>/dev/null |
        awk -F '\t' '
        function parameters(signature,   i, c, depth, count) {
            if (signature ~ /^\((void)?\)/) return 0
            count = 1
            for (i = 1; i <= length(signature); i++) {
                c = substr(signature, i, 1)
                depth += (c == "(") - (c == ")")
                if (c == "," && depth == 1) count++
            }
            return count
        }
        # The comment that ends directly above a line, back to where it begins.
        function above(file, line,   i, text, n) {
            if (file != held) {
                while ((getline text < file) > 0) lines[++n] = text
                close(file)
                held = file
            }
            i = line - 1
            while (i > 0 && lines[i] ~ /^(static|inline|extern|template|__attribute__)/ && lines[i] !~ /[;}]$/) i--
            if (lines[i] !~ /\*\/$|^ *\/\//) return ""
            text = lines[i]
            while (i > 0 && lines[i] !~ /^ *\/[*\/]/) text = lines[--i] " " text
            return text
        }
        # Whether one sentence of it has the word and a reason.
        function says_why(comment, word,   i, n, sentences) {
            gsub(/[ \t]*\n?[ \t]*\*[ \t]+/, " ", comment)
            n = split(comment, sentences, /[.;]([ \t]|$)/)
            for (i = 1; i <= n; i++)
                if (sentences[i] ~ word && sentences[i] ~ /(because|since|so that|which) /) return 1
            return 0
        }
        /^!/ { next }
        {
            line = end = 0
            signature = ""
            for (i = 4; i <= NF; i++) {
                if ($i ~ /^line:/) line = substr($i, 6) + 0
                if ($i ~ /^end:/) end = substr($i, 5) + 0
                if ($i ~ /^signature:/) signature = substr($i, 11)
            }
            long = end - line + 1
            count = parameters(signature)
            if (long > 80 && !says_why(above($2, line), "lines"))
                print $2 ":" line ": " $1 " has " long " lines, more than 80, and no comment above says why"
            if (count > 8 && !says_why(above($2, line), "parameters"))
                print $2 ":" line ": " $1 " has " count " parameters, more than 8, and no comment above says why"
        }'
}

check() { # ROOT
    (cd "$1" && { files; functions; } | awk '{ print; failed = 1 } END { exit failed }')
}

if ! ctags --version 2>/dev/null | grep -q Universal; then
    echo "This takes universal-ctags (tools/dependencies.sh tests)."
    exit 1
fi
if [ "$1" != --self-test ]; then
    check "$1"
    exit
fi

scratch=$2
failures=0
expect() { # accepted|refused WHAT; the file is $scratch/runtime/a.c
    if check "$scratch" >"$scratch/output" 2>&1; then found=accepted; else found=refused; fi
    if [ "$found" != "$1" ]; then
        echo "$2: $found, but should be $1"
        cat "$scratch/output"
        failures=$((failures + 1))
    fi
}
lines() { # COUNT
    awk -v n="$1" 'BEGIN { for (i = 0; i < n; i++) print "    x++;" }'
}
rm -rf "$scratch"
mkdir -p "$scratch/runtime"
file=$scratch/runtime/a.c
opening='/* What this file is for. */'
{ echo "$opening"; echo 'int f(int x) {'; lines 78; echo '}'; } >"$file"
expect accepted "a function of 80 lines"
{ echo "$opening"; echo 'int f(int x) {'; lines 79; echo '}'; } >"$file"
expect refused "a function of 81 lines"
{ echo "$opening"; echo '/* Its'; echo ' * lines are many since they are one table. */'; echo 'static'; echo 'int f(int x) {'; lines 79; echo '}'; } >"$file"
expect accepted "a long function that says why"
{ echo "$opening"; echo '/* Its lines. Since then all is well. */'; echo 'int f(int x) {'; lines 79; echo '}'; } >"$file"
expect refused "a long function that names its lines and no reason"
{ echo "$opening"; echo '/* Its lines are many since they are one table. */'; echo 'int y;'; echo 'int f(int x) {'; lines 79; echo '}'; } >"$file"
expect refused "a long function below another's comment"
{ echo "$opening"; echo 'int f(int a, int b, int c, int d, int e, int g, int h, int (*i)(int, int)) {'; echo '}'; } >"$file"
expect accepted "eight parameters"
{ echo "$opening"; echo 'int f(int a, int b, int c, int d, int e, int g, int h, int i,'; echo 'int j) {'; echo '}'; } >"$file"
expect refused "nine parameters"
{ echo "$opening"; lines 599; } >"$file"
expect accepted "600 lines"
{ echo "$opening"; lines 600; } >"$file"
expect refused "601 lines"
echo '#include <stdio.h>' >"$file"
expect refused "a file without a comment"
echo '/* x */' >"$file"
expect refused "a comment that says nothing"
exit $((failures != 0))
