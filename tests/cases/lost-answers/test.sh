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
loses "--help"
loses "--version"
for verb in render compare reference info check diff convert merge transfer sample; do
    loses "$verb --help"
done
run sh -c 'selvage --version >&-'
[ $code = 1 ] || fail "closed: exit code $code"
run sh -c 'selvage convert in.ptx out.ptx --json >&-'
[ $code = 1 ] || fail "closed: exit code $code"
accepts selvage check out.ptx
