#!/bin/sh
# Makes the picture of wrap.md: a tube and a torus with plain interpolation, with duplicated vertices, and with the method. Needs
# ImageMagick.
#   docs/wrap_pictures.sh build/bin
set -eu
bin=$(cd "${1:?the folder with selvage}" && pwd)
docs=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# mesh NAME TORUS TWICE: 24 quads around, and 4 up a tube or 12 around a torus. The map ends in front, and within the ring of a torus.
mesh() {
    awk -v torus="$2" -v twice="$3" 'BEGIN {
        turn = 6.283185307179586; around = 24; rows = torus ? 12 : 4
        width = around + twice; height = rows + (torus ? twice : 1)
        for (y = 0; y < height; y++)
            for (x = 0; x < width; x++) {
                a = turn * (x % around) / around; r = 0.7; up = 2 * y / rows - 1
                if (torus) { b = turn * (y % rows) / rows + 2.5; r = 1 + 0.45 * cos(b); up = 0.45 * sin(b) }
                printf "v %.9g %.9g %.9g\nvt %.9g %.9g\n", r * sin(a), up, r * cos(a), x / around + twice, y / rows + twice
            }
        for (y = 0; y < rows; y++)
            for (x = 0; x < around; x++) {
                p = y * width + x + 1; q = y * width + (x + 1) % width + 1
                s = (y + 1) % height * width + x + 1; t = (y + 1) % height * width + (x + 1) % width + 1
                printf "f %d/%d %d/%d %d/%d %d/%d\n", p, p, q, q, t, t, s, s
            }
    }' >"$1"
}
# Hues around, with lines. (Coordinates of the meshes with duplicated vertices leave 0..1, which makes the image repeat.)
awk 'BEGIN {
    printf "P3\n384 192\n255\n"
    for (y = 0; y < 192; y++)
        for (x = 0; x < 384; x++) {
            line = x % 32 < 3 || y % 48 < 3
            for (c = 0; c < 3; c++) {
                h = (x / 384 + c / 3) % 1 * 6; h = h < 3 ? h : 6 - h
                v = h < 1 ? 0 : h < 2 ? h - 1 : 1
                printf "%d ", line ? 40 : 90 + 150 * v
            }
        }
}' | convert ppm:- hues.png

# shot NAME MESH ROUND DETAIL OPTIONS: a picture with a part of it larger in its corner.
shot() {
    name=$1 mesh=$2 round=$3 detail=$4
    shift 4
    "$bin/selvage" render "$mesh" --uv hues.png --round "$round" --scheme bilinear --aniso 16 --size 300x240 --background white \
        --quiet -o "$name.png" "$@"
    convert "$name.png" \( +clone -crop "$detail" +repage -filter point -resize 90x90 -bordercolor black -border 1 \) \
        -gravity southeast -composite "$name.png"
}
mesh tube.obj 0 0
mesh tube_twice.obj 0 1
mesh torus.obj 1 0
mesh torus_twice.obj 1 1
shot tube_plain tube.obj no 36x36+108+100 --azimuth 12
shot tube_twice tube_twice.obj no 36x36+108+100 --azimuth 12
shot tube_method tube.obj u 36x36+108+100 --azimuth 12
shot torus_plain torus.obj no 44x44+98+136 --azimuth 12 --elevation 50
shot torus_twice torus_twice.obj no 44x44+98+136 --azimuth 12 --elevation 50
shot torus_method torus.obj both 44x44+98+136 --azimuth 12 --elevation 50
convert \( tube_plain.png tube_twice.png tube_method.png +append \) \( torus_plain.png torus_twice.png torus_method.png +append \) \
    -append +dither -colors 200 "$docs/images/wrap.png"
for shape in tube torus; do
    "$bin/selvage" wrap "${shape}_twice.obj" once.obj
done

# What wrap.md has of a comparison: the place where the maps differ most, and the table.
"$bin/selvage" bake torus.obj --uv hues.png --round both --scheme bilinear --match 2 --reductions seamless --quiet -o torus.ptx
"$bin/selvage" compare torus.ptx --mesh torus.obj --uv hues.png --round both --scheme bilinear --msaa 4 --size 480x270 --frames 24 \
    --reference-frames 6 --reference-samples 64 --elevation 35 --strategies clamp,borders,traverse,discard --quiet --out report
for map in reference uv-plain uv-duplicated uv-wrapped clamp traverse; do
    convert "report/map_close_$map.png" -resize 150x150 -gravity south -background white -splice 0x16 -font DejaVu-Sans -pointsize 12 \
        -annotate +0+1 "$map" "close_$map.png"
done
convert close_reference.png close_uv-plain.png close_uv-duplicated.png close_uv-wrapped.png close_clamp.png close_traverse.png +append \
    +dither -colors 200 "$docs/images/wrap_compare.png"
cat report/maps.csv
