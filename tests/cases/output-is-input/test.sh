# An output that is one of the inputs, by whatever name, is refused; a texture may be replaced by its new self.
cp in.ptx a.ptx
cp q.txt queries.txt
ln a.ptx hard.txt
ln -s a.ptx soft.png
ln -s queries.txt lookups.txt
run selvage sample a.ptx --queries q.txt --out a.ptx
[ $code != 0 ] || fail "answers in place of the texture"
for out in hard.txt soft.png; do
    refuses selvage sample a.ptx --queries q.txt --out $out
    says "would be lost"
done
refuses selvage sample a.ptx --queries queries.txt --out lookups.txt
refuses selvage sample a.ptx --queries lookups.txt --out queries.txt
refuses selvage render a.ptx --size 16x16 -o soft.png
refuses selvage info a.ptx --sheet soft.png
refuses selvage convert a.ptx soft.png
refuses selvage merge a.ptx in.ptx -o a.ptx
ln -s a.ptx b.ptx
refuses selvage merge in.ptx b.ptx -o a.ptx
refuses selvage convert a.ptx b.ptx
cp a.ptx whole.png
refuses selvage convert whole.png whole.png
says "would be lost"
cmp -s in.ptx whole.png || fail "whole.png is another"
# Standard input is an input like others.
printf '{"azimuth": 30}\n' >v.png
cp v.png view.json
cp mesh.obj m.ptx
ln -s queries.txt soft.txt
try() { # COMMAND FILE: the file is both
    run sh -c "$1 <$2"
    [ $code = 1 ] || fail "$1 <$2: exit code $code: $said"
    says "would be lost"
}
try "selvage sample a.ptx --out queries.txt" queries.txt
try "selvage sample a.ptx -i - --out queries.txt" queries.txt
try "selvage sample a.ptx -i /dev/stdin --out soft.txt" queries.txt
try "selvage sample a.ptx --out queries.txt" soft.txt
try "selvage render a.ptx --size 16x16 --view - -o v.png" v.png
try "selvage transfer a.ptx m.ptx --to -" m.ptx
try "selvage new - m.ptx --size 2" m.ptx
try "selvage convert a.ptx m.ptx --mesh -" m.ptx
try "selvage check a.ptx --mesh - --repair m.ptx" m.ptx
cmp -s v.png view.json || fail "the view is lost"
cmp -s mesh.obj m.ptx || fail "the mesh is lost"
cmp -s in.ptx a.ptx || fail "a.ptx is another"
cmp -s q.txt queries.txt || fail "queries.txt is another"
accepts selvage convert a.ptx a.ptx --scale 1/2
accepts selvage check a.ptx --repair a.ptx
accepts selvage sample a.ptx --queries q.txt --out answers.txt
mkdir parts
accepts selvage merge a.ptx in.ptx -o parts/a.ptx
cp parts/a.ptx whole.ptx
refuses selvage split parts/a.ptx -o parts
says "would be lost"
cmp -s whole.ptx parts/a.ptx || fail "the whole is lost to a part of its name"
accepts selvage split whole.ptx -o parts
# A view file may lie in the folder of a report, but not where the report puts a file.
mkdir report
printf '{"azimuth": 30}\n' >report/report.json
refuses selvage compare in.ptx --view report/report.json --out report
says "would be lost"
grep -q azimuth report/report.json || fail "the view is lost"
