# An answer that cannot be written is an error of every verb, and of help.
loses() {
    run sh -c "selvage $1 >/dev/full"
    [ $code != 0 ] || fail "$1: exit code 0"
    case $said in
    *"cannot write the answer: "*) ;;
    *) fail "$1: $said" ;;
    esac
}
accepts selvage convert in.ptx other.ptx --scale 2
accepts selvage merge in.ptx in.ptx -o out.ptx
small="--size 32x32"
loses "reference in.ptx --samples 1 $small -o a.exr --json"
loses "reference in.ptx --samples 1 $small -o a.exr"
loses "render in.ptx $small -o a.png"
loses "info in.ptx"
loses "info in.ptx --json"
loses "check in.ptx"
loses "diff in.ptx in.ptx"
loses "diff in.ptx other.ptx"
loses "convert in.ptx out.ptx --json"
loses "merge in.ptx in.ptx -o out.ptx"
loses "split out.ptx -o parts"
loses "pick in.ptx 256 256"
loses "help render"
loses "--help"
loses "--version"
for verb in $(selvage --help | sed -n "s/^  \([a-z]*\) .*/\1/p"); do
    loses "$verb --help"
done
run sh -c 'selvage --version >&-'
[ $code = 1 ] || fail "closed: exit code $code"
run sh -c 'selvage convert in.ptx out.ptx --json >&-'
[ $code = 1 ] || fail "closed: exit code $code"
accepts selvage check out.ptx
