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
for windows in crop8 crop10; do
    "$selvage" convert "$data/windows/$windows" crop.ptx
    "$selvage" info crop.ptx | grep -q "16 x 16" || die "$windows: $("$selvage" info crop.ptx)"
done
