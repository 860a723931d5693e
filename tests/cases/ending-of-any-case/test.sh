# The ending of a sheet keeps its case, and a file that differs in it is left alone.
cp sheet.png t.png
accepts selvage convert in.ptx t.PNG
cmp -s sheet.png t.png || fail "t.png is another"
[ -s t.PNG ] || fail "no t.PNG"
accepts selvage convert t.json back.ptx
accepts selvage diff in.ptx back.ptx --texels
accepts selvage convert in.ptx u.Exr
[ -s u.Exr ] || fail "no u.Exr"
accepts selvage info in.ptx --sheet s.PNG
accepts selvage render in.ptx --size 16x16 -o r.Png --quiet
accepts selvage reference in.ptx --size 16x16 --samples 1 -o r.EXR --quiet
[ -s s.PNG ] && [ -s r.Png ] && [ -s r.EXR ] || fail "names were changed"
