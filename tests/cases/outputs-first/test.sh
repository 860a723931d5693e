# What cannot be written is said before the first ray: nothing else is said, progress neither.
for where in nowhere in.ptx /proc; do
    refuses selvage reference in.ptx --samples 64 -o $where/a.exr
    says "$where/a.exr: cannot be written: "
    refuses selvage reference in.ptx --samples 64 -o a.exr --error $where/e.exr
    says "$where/e.exr: cannot be written: "
    refuses selvage reference in.ptx --samples 64 -o a.exr --convergence $where/study
    says "$where/study: cannot be written: "
    refuses selvage compare in.ptx --out $where/report
    says "$where/report: cannot be written: "
    refuses selvage render missing.ptx -o $where/a.png
    says "$where/a.png: cannot be written: "
    refuses selvage info missing.ptx --sheet $where/a.png
    refuses selvage transfer missing.ptx $where/o.ptx --to missing.obj
    says "$where/o.ptx: cannot be written: "
    refuses selvage check missing.ptx --repair $where/o.ptx
    says "$where/o.ptx: cannot be written: "
    refuses selvage merge missing.ptx in.ptx -o $where/o.ptx
    says "$where/o.ptx: cannot be written: "
    run selvage diff missing.ptx in.ptx --images $where/i
    [ $code != 0 ] || fail "diff: $said"
    says "$where/i: cannot be written: "
done
[ "$(ls)" = "$(printf 'in.ptx\ntest.sh')" ] || fail "something is left: $(ls)"
