# A limit of file sizes is as a full disk: a message, and nothing is left.
files=$(ls)
limited() {
    run sh -c "ulimit -f 1; $*"
    [ $code = 1 ] || fail "$*: exit code $code: $said"
    says "File too large"
    [ "$(ls)" = "$files" ] || fail "$*: something is left: $(ls)"
}
limited selvage render in.ptx --size 512x512 -o big.png
limited selvage render in.ptx --size 512x512 -o big.exr
limited selvage reference in.ptx --size 64x64 --samples 1 -o big.exr --quiet
limited selvage info in.ptx --cell 1024 --sheet big.exr
limited selvage convert in.ptx big.ptx --type float
limited selvage split in.ptx --at 0,20 -o parts
limited selvage render in.ptx --pass ids -o ids.exr
limited selvage convert in.ptx faces --format exr
limited selvage convert in.ptx sheet.exr
# what a killed run left goes with the next one
echo half >big.png.0.selvage
mkdir faces.0.selvage
accepts selvage render in.ptx --size 16x16 -o big.png --quiet
accepts selvage convert in.ptx faces
[ ! -e big.png.0.selvage ] && [ ! -e faces.0.selvage ] || fail "not removed: $(ls)"
