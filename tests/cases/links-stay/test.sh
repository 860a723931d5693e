# What a link leads to is replaced and keeps its mode; the link stays.
mkdir real
for f in a.png b.exr c.png d.txt; do
    : >real/$f
    chmod 600 real/$f
    ln -s real/$f $f
done
accepts selvage render in.ptx -o a.png --size 64x64
accepts selvage reference in.ptx -o b.exr --samples 1 --size 64x64 --quiet
accepts selvage convert in.ptx c.png
accepts selvage sample in.ptx --queries q.txt --out d.txt
for f in a.png b.exr c.png d.txt; do
    [ -L $f ] || fail "$f is no link any more"
    [ -s real/$f ] || fail "real/$f is empty"
    [ "$(stat -c %a real/$f)" = 600 ] || fail "real/$f has another mode"
done
[ "$(ls real | wc -l)" = 4 ] || fail "something is left in real: $(ls real)"
