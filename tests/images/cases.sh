#!/bin/sh
# Folders of pictures that other programs made of exported ones: cases.sh SELVAGE DATA
# shellcheck disable=SC2310
set -eu
selvage=$1 data=$2 folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

die() {
    echo "$*" >&2
    exit 1
}

# PNGs of RGBA after a program that stores opaque grey as grey.
"$selvage" convert "$data/grey_png/faces" grey.ptx
"$selvage" diff "$data/grey_png/original.ptx" grey.ptx

# B44 whose chunks did not become smaller, and so are stored plain, against the same without compression.
for kind in 16f 2h; do
    "$selvage" convert "$data/b44_plain/$kind" packed.ptx
    "$selvage" convert "$data/b44_plain/plain_$kind" plain.ptx
    "$selvage" diff plain.ptx packed.ptx --texels --tolerance 0.13
done

# A display window of 16 x 16: the image, whatever the data window has.
for windows in over20 over32; do
    "$selvage" convert "$data/windows/$windows" over.ptx
    "$selvage" diff "$data/windows/original.ptx" over.ptx
done
# Of a smaller data window each texel inside is the picture's, and each outside is zero.
awk 'BEGIN { for (i = 0; i < 256; i++) print "point 0 0 0 1 0 0 3 0", (i % 16 + 0.5) / 16, (int(i / 16) + 0.5) / 16, "0 0 0 0" }' >texels
"$selvage" sample "$data/windows/original.ptx" -i texels | sed 's/.*-> //' >whole
for side in 8 10; do
    "$selvage" convert "$data/windows/crop$side" crop.ptx
    "$selvage" info crop.ptx | grep -q "16 x 16" || die "crop$side: $("$selvage" info crop.ptx)"
    "$selvage" sample crop.ptx -i texels | sed 's/.*-> //' >crop
    paste -d ' ' whole crop | awk -v side=$side '
        {
            x = (NR - 1) % 16
            y = int((NR - 1) / 16)
            low = (16 - side) / 2
            inside = x >= low && x < low + side && y >= low && y < low + side
            for (c = 1; c <= 3; c++) if ($(c + 3) != (inside ? $c : 0)) wrong++
            if (inside && $1 != 0) seen++
        }
        END { exit wrong || NR != 256 || !seen }' || die "crop$side: $(cat crop)"
done
