# .ptex is the name that OpenImageIO, XGen and others use for textures; other endings are no folders.
accepts selvage convert in.ptex out.ptex
[ -f out.ptex ] || fail "out.ptex is no file"
accepts selvage merge in.ptex in.ptex -o m.PTEX
accepts selvage info m.PTEX --json
says '"faces": 4'
accepts selvage check in.ptex --repair mended.ptex
for name in out.tga out.jpg out.BMP out.hdr out.webp out.ptx.gz sub/out.tx -; do
    run selvage convert in.ptex $name
    [ $code = 2 ] || fail "$name: exit code $code: $said"
    says "expected a folder"
    [ ! -e $name ] || fail "$name was written"
done
accepts selvage convert in.ptex faces.tga/
[ -f faces.tga/index.json ] || fail "no folder although it was asked for"
accepts selvage convert in.ptex faces.tga
accepts selvage convert in.ptex out.2024
[ -d out.2024 ] || fail "out.2024 is no folder"
