#!/bin/sh
# Exported pictures go through ImageMagick and OpenEXR's tools in the forms that these write, and come back as the same
# texels: programs.sh SELVAGE DATA
set -eu
selvage=$1 data=$2 folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
magick=$(command -v mogrify-im6.q16 || command -v mogrify || true)
if [ -z "$magick" ] || ! command -v exrmaketiled >log; then
    echo "ImageMagick and OpenEXR's tools are needed: tools/dependencies.sh tests installs them" >&2
    exit 1
fi

die() {
    echo "$*" >&2
    exit 1
}

# pictures TEXTURE TYPE: exports it, once for all that is done to it; the pictures are in faces/
exported=
pictures() {
    rm -rf faces
    if [ "$exported" != "$1 $2" ]; then
        rm -rf untouched
        "$selvage" convert "$data/$1" original.ptx --type "$2" --max 8x8
        "$selvage" convert original.ptx untouched
        exported="$1 $2"
    fi
    cp -r untouched faces
}

# in a short run every third of what comes one after the other
turn=0
left_out() {
    turn=$((turn + 1))
    [ -z "${SELVAGE_TEST_EFFORT:-}" ] && [ $((turn % 3)) != 0 ]
}

# same WHAT [OPTIONS]: faces/ is the original, but for what the options of diff allow
same() {
    what=$1
    shift
    "$selvage" convert faces back.ptx || die "$what: cannot be read"
    "$selvage" diff original.ptx back.ptx "$@" >differences || die "$what: $(cat differences)"
}

# Colour types 0 grey, 2 RGB, 3 palette, 4 grey and alpha, 6 RGBA; what loses nothing for each kind of texture.
for row in \
    "extra_u8_3.ptx uint8 2 3 6" "edits_u8_4.ptx uint8 6" "single_periodic_u8_1.ptx uint8 0 2 3 4 6" \
    "const_u8_3.ptx uint8 2 3 6" "editsapplied_u16_3.ptx uint16 2 6" "cube_u16_rgba.ptx uint16 6" \
    "ngon_tanvec_u16_2.ptx uint16 4 6"; do
    # shellcheck disable=SC2086
    set -- $row
    texture=$1 type=$2
    shift 2
    pictures "$texture" "$type"
    "$magick" -strip faces/*.png
    same "$texture after -strip"
    for colour in "$@"; do
        for how in "-interlace none" "-interlace PNG" "-depth 16 -define png:bit-depth=16"; do
            ! left_out || continue
            [ "$colour$how" != "3-depth 16 -define png:bit-depth=16" ] || continue
            pictures "$texture" "$type"
            # shellcheck disable=SC2086
            "$magick" $how -define png:color-type="$colour" faces/*.png
            same "$texture as colour type $colour, $how"
        done
    done
done

# Tiles and reductions of every compression.
for compression in none rle zip piz pxr24 b44 b44a dwaa dwab; do
    for levels in -o -m -r; do
        ! left_out || continue
        pictures tiled_half_3.ptx half
        for picture in faces/*.exr; do
            exrmaketiled $levels -t 4 4 -z $compression "$picture" tiled.exr
            mv tiled.exr "$picture"
        done
        case $compression in
        b44* | dwa*) same "tiles of $compression, $levels" --texels --tolerance 0.3 ;;
        *) same "tiles of $compression, $levels" ;;
        esac
    done
done

# The first of several parts.
pictures tiled_half_3.ptx half
cp faces/face_000000.exr other.exr
for picture in faces/*.exr; do
    exrmultipart -combine -i "$picture" other.exr -o parts.exr >log || die "exrmultipart: $(cat log)"
    mv parts.exr "$picture"
done
same "several parts"
