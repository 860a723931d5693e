# Runs the test.sh of a folder of this one, in a copy that it may write to, with `selvage` in the path.
folder=$1
parent=${TMPDIR:-/tmp}
if [ -z "$TMPDIR" ] && [ -w /dev/shm ] && [ "$(df -Pk /dev/shm | awk 'NR == 2 { print $4 }')" -gt 1048576 ]; then
    parent=/dev/shm # no waiting for a disk
fi
scratch=$(mktemp -d "$parent/selvage-case-XXXXXX") || exit 1
trap 'rm -rf "$scratch"' EXIT
cp -r "$folder/." "$scratch" && chmod -R u+w "$scratch" && cd "$scratch" || exit 1
PATH=$SELVAGE_BIN:$PATH

fail() {
    echo "$*" >&2
    exit 1
}

# Runs a command; what it says, in both streams, is then in $said, its exit code in $code.
run() {
    said=$("$@" 2>&1)
    code=$?
}

accepts() {
    run "$@"
    [ $code = 0 ] || fail "$*: exit code $code: $said"
}

# One line, and exit code 1.
refuses() {
    run "$@"
    [ $code = 1 ] || fail "$*: exit code $code, expected 1: $said"
    [ "$(printf '%s\n' "$said" | wc -l)" = 1 ] || fail "$*: more than one line: $said"
}

says() {
    case $said in
    *"$1"*) ;;
    *) fail "not said: '$1', but: $said" ;;
    esac
}

. ./test.sh
