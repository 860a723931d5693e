# The command lines that compare_builds.sh runs with both builds, and the files they read; sourced by it.
# shellcheck shell=bash disable=SC2154
# A case is a line: group, name, and commands for run_case.sh, in which `t` is `selvage`.

add() { # group name commands
    printf '%s\t%s\t%s\n' "$1" "$2" "$3"
}

# A value of `selvage info --json`, of the outermost object.
info_of() { # FILE key
    of_build "$old" selvage info "$1" --json | sed -n "s/^  \"$2\": \"*\([a-z0-9]*\)\"*,*\$/\1/p" | head -n 1
}

# Files with a byte changed, and one cut short: what is made of damage is to be the same, too.
make_damaged() { # FILE
    local name size k at
    name=$(basename "$1" .ptx)
    size=$(stat -c %s "$1")
    head -c $((size / 2)) "$1" >"$work/in/damaged/${name}_cut.ptx"
    for k in 1 2 3 4 5 6; do
        at=$((size * k / 7))
        { head -c "$at" "$1"; printf '\xa5'; tail -c +$((at + 2)) "$1"; } >"$work/in/damaged/${name}_$k.ptx"
    done
}

# Samples, each with an OBJ of the same name beside it.
copy_samples() {
    local file
    [ -d "${SELVAGE_SAMPLES:-}" ] || return 0
    for file in "$SELVAGE_SAMPLES"/*/*.ptx; do
        [ -f "$file" ] || continue
        cp "$file" "$work/in/samples/"
        if [ -f "${file%.ptx}.obj" ]; then cp "${file%.ptx}.obj" "$work/in/samples/"; fi
        if [ -f "$(dirname "$file")/view.json" ]; then
            cp "$(dirname "$file")/view.json" "$work/in/samples/$(basename "$file" .ptx).json"
        fi
    done
}

# Every file in `in`, by group of origin: data, more, samples, demo, made; damaged ones are in lists of their own.
make_inputs() {
    local in=$work/in file every=1
    mkdir -p "$in"/{data,more,samples,made,damaged,queries}
    cp "$data"/*.ptx "$in/data/"
    copy_samples
    if [ "$quick" = 0 ] && [ -d "${SELVAGE_CONFORMANCE:-}" ]; then
        for file in "$SELVAGE_CONFORMANCE"/*.ptx; do
            if [ -f "$file" ] && [ ! -f "$in/data/$(basename "$file")" ]; then cp "$file" "$in/more/"; fi
        done
    fi
    chmod -R u+w "$in"
    cp "$root/assets/cube.obj" "$in/cube.obj"
    made convert "$in/demo/scene.ptx" "$in/made/half.ptx" --type half --scale 1/4
    made convert "$in/demo/scene.ptx" "$in/made/grey16.ptx" --type uint16 --channels 1 --scale 1/4
    made convert "$in/demo/scene.ptx" "$in/made/alpha.ptx" --channels 0,1,2,1 --alpha 3 --scale 1/2
    if [ -f "$in/data/cube_u16_rgba.ptx" ]; then
        made convert "$in/data/cube_u16_rgba.ptx" "$in/made/cube.ptx" --mesh "$in/cube.obj"
    fi
    for file in "$in/demo/scene.obj" "$in/cube.obj" "$in"/samples/*.obj; do
        if [ -f "$file" ]; then
            awk '/^v / { printf "v %.6f %.6f %.6f\n", $2 * 1.01 + 0.01 * ($3 > 0), $3, $4 - 0.004 * $2; next } 1' \
                "$file" >"$in/made/$(basename "$file" .obj)_moved.obj"
        fi
    done
    for file in "$in"/data/*.ptx; do
        if [ $((every++ % (quick ? 9 : 3))) = 1 ]; then make_damaged "$file"; fi
    done
    make_queries
}

made() { # arguments of selvage
    of_build "$old" selvage "$@" >/dev/null 2>"$work/why" ||
        echo "left out: selvage $1 $(basename "$3"): $(cat "$work/why")"
}

make_queries() {
    local file seed=1 faces channels
    for file in $(all_files); do
        faces=$(info_of "$work/in/$file" faces) channels=$(info_of "$work/in/$file" channels)
        for bad in 0 1; do
            awk -v filters="$(tr '\n' ' ' <<<"$filters")" -v faces="${faces:-1}" -v channels="${channels:-1}" \
                -v seed=$((seed++ * 7919)) -v bad="$bad" -v count=$((quick ? 100 : 700)) -f "$here/queries.awk" \
                >"$work/in/queries/$(query_name "$file").$bad.txt"
        done
    done
}

query_name() { tr / _ <<<"${1%.ptx}"; }

# All whole files, as paths below `in`.
all_files() {
    (cd "$work/in" && find data more samples made demo -name '*.ptx' | sort)
}

few_files() { # with --quick every third and not the large ones; else all
    if [ "$quick" = 1 ]; then all_files | awk 'NR == 1 || !/^(demo|made)/ && NR % 3 == 1'; else all_files; fi
}

damaged_files() {
    (cd "$work/in" && find damaged -name '*.ptx' | sort)
}

cases_help() {
    local verb
    add help version "t --version"
    add help "no verb" "t; t --help; t nonsense"
    for verb in $(of_build "$old" selvage --help | sed -n '/^Verbs:/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
        add help "$verb --help" "t $verb --help"
        add help "$verb, wrong usage" "t $verb; t $verb --nonsense; t $verb in/nothing.ptx; t $verb in/cube.obj; \
t $verb in/demo/scene.ptx --threads x; t $verb in/demo/scene.ptx --quiet --out nowhere/x --to in/nothing.obj"
    done
}

cases_info() {
    local f g previous=
    for f in $(all_files) $(damaged_files); do
        add info "info --json $f" "t info in/$f --json"
        add info "info --list-faces --meta $f" "t info in/$f --list-faces --meta"
        add info "check --json $f" "t check in/$f --json"
        if [ "$quick" = 0 ]; then
            add info "check $f" "t check in/$f --seams 0.01; t check in/$f --tables --strict --show 3"
        fi
    done
    for f in $(all_files); do
        add info "diff $f" "t diff in/$f in/$f --json; t diff in/$f in/$f"
        if [ -n "$previous" ]; then
            add info "diff $previous $f" "t diff in/$previous in/$f; t diff in/$previous in/$f --json --texels"
        fi
        previous=$f
    done
    for g in demo/scene cube samples/teapot samples/nonquad; do
        if [ -f "$work/in/$g.obj" ]; then
            add info "info $g.obj" "t info in/$g.obj; t info in/$g.obj --json"
            f=$g.ptx
            [ "$g" = cube ] && f=made/cube.ptx
            add info "check --mesh $g.obj" "t check in/$f --mesh in/$g.obj; t check in/$f --mesh in/$g.obj --json"
        fi
    done
}

cases_convert() {
    local f type
    for f in $(few_files); do
        for type in uint8 uint16 half float; do
            add convert "convert --type $type $f" "t convert in/$f out.ptx --type $type --json"
        done
        add convert "convert --scale $f" \
            "t convert in/$f half.ptx --scale 1/2; t convert in/$f twice.ptx --scale 2 --max 64; \
t convert in/$f min.ptx --min 16x8 --max 16; t convert in/$f res.ptx --res 0=4x16"
        add convert "convert --channels $f" \
            "t convert in/$f one.ptx --channels 0; t convert in/$f alpha.ptx --channels 0,=0.5 --alpha 1; \
t convert in/$f three.ptx --channels 2,1,0 --type half --alpha none"
        add convert "convert --premultiply $f" \
            "t convert in/$f p.ptx --premultiply; t convert in/$f u.ptx --unmultiply --type float"
        add convert "convert --border $f" \
            "t convert in/$f b.ptx --border periodic --edge-filter tanvec; \
t convert in/$f c.ptx --border-u clamp --border-v black --edge-filter none --no-meta"
        add convert "convert --compression $f" \
            "t convert in/$f fast.ptx --compression 1 --reductions; t convert in/$f small.ptx --compression 12; \
t convert in/$f none.ptx --no-reductions --threads 1"
    done
    for f in $(damaged_files); do add convert "convert $f" "t convert in/$f out.ptx --scale 1/2"; done
}

cases_images() {
    local f
    for f in $(few_files); do
        # A folder of the demo scene has thousands of files.
        if [[ $f != demo/* && $f != made/* ]]; then
            add images "convert to a folder and back $f" "t convert in/$f faces; t convert faces again.ptx"
            add images "convert to a folder of EXR $f" \
                "t convert in/$f faces --format exr --type half --max 8; t convert faces again.ptx --type uint16"
        fi
        add images "convert to a sheet and back $f" \
            "t convert in/$f sheet.exr --type half; t convert sheet.json again.ptx; \
t convert in/$f sheet8.png --type uint8 --max 16; t convert sheet8.json again8.ptx"
        add images "info --sheet $f" \
            "t info in/$f --sheet all.png; t info in/$f --sheet some.exr --cell 24 --sheet-faces 0-5; \
t info in/$f --sheet raw.png --encoding raw --cell 16"
    done
}

cases_edit() {
    local f g previous=
    for f in $(few_files); do
        add edit "merge $f with itself" \
            "t merge in/$f in/$f -o twice.ptx; t merge in/$f in/$f -o half.ptx --type half --json --no-reductions"
        if [ -n "$previous" ]; then
            add edit "merge $previous and $f" "t merge in/$previous in/$f -o out.ptx --compression 3"
        fi
        add edit "diff --images $f" \
            "t convert in/$f small.ptx --scale 1/2 --type half; t diff in/$f small.ptx --texels --images faces --json; \
t diff in/$f small.ptx --tolerance 0.05 --images reals --format exr --show 4"
        add edit "check --repair $f" "t check in/$f --repair mended.ptx; t check mended.ptx --json"
        previous=$f
    done
    for f in $(damaged_files); do
        add edit "check --repair $f" "t check in/$f --repair mended.ptx; t info mended.ptx"
    done
    cases_transfer samples/teapot samples/teapot.obj teapot
    cases_transfer samples/nonquad samples/nonquad.obj nonquad
    cases_transfer made/cube cube.obj cube
    if [ "$quick" = 0 ]; then cases_transfer made/half demo/scene.obj scene; fi
    for f in $(few_files); do
        add edit "transfer $f" "t transfer in/$f out.ptx --from in/cube.obj --to in/made/cube_moved.obj --list-faces"
    done
}

# Faces that are found, taken out or gone past.
cases_faces() {
    local f g m
    for f in $(few_files); do
        add faces "pick $f" \
            "t pick in/$f 256 256; t pick in/$f 100 300 --size 400x400 --json; t pick in/$f 0 0; \
t pick in/$f 256 256 --mesh in/cube.obj"
        add faces "split $f" \
            "t merge in/$f in/$f -o pair.ptx; t split pair.ptx parts; t diff in/$f parts/$(basename "$f"); \
t split in/$f one; t split in/$f halves --at 1 --json"
        add faces "convert --faces $f" "t convert in/$f some.ptx --faces 0,2-3; t convert in/$f none.ptx --faces 4000000"
        add faces "info --sheet --ids $f" "t info in/$f --sheet ids.png --ids --sheet-faces 0-3"
    done
    for g in demo/scene:demo/scene made/cube:cube samples/teapot:samples/teapot; do
        f=${g%:*}.ptx m=${g#*:}.obj
        if [ -f "$work/in/$f" ] && [ -f "$work/in/$m" ]; then
            add faces "render --pass ids $f" \
                "t render in/$f ids.exr --mesh in/$m --pass ids --size 80x60; \
t render in/$f ids.png --mesh in/$m --pass ids --size 80x60"
        fi
    done
    for f in $(damaged_files); do
        add faces "--salvage $f" \
            "t convert in/$f whole.ptx --salvage; t diff in/$f in/$f --salvage --json; \
t transfer in/$f moved.ptx --to in/made/cube_moved.obj --from in/cube.obj --salvage"
    done
}

cases_transfer() { # texture, its mesh, name of the changed mesh
    local f=$1.ptx to=in/made/$3_moved.obj
    if [ ! -f "$work/in/$f" ] || [ ! -f "$work/in/$2" ]; then return 0; fi
    add edit "transfer $f" \
        "t transfer in/$f out.ptx --to $to --from in/$2; t transfer in/$f inside.ptx --to $to --list-faces"
    add edit "transfer --blank $f" \
        "t transfer in/$f out.ptx --to $to --from in/$2 --blank --distance 0.004 --json --scheme bilinear"
    add edit "transfer --no-copies $f" "t transfer in/$f out.ptx --to in/$2 --from in/$2 --no-copies --json"
}

cases_sample() {
    local f q
    for f in $(all_files); do
        q=in/queries/$(query_name "$f")
        add sample "sample $f" "t sample in/$f --queries $q.0.txt"
        add sample "sample --premultiply $f" "t sample in/$f --queries $q.0.txt --premultiply --threads 1 --out answers"
        if [ "$quick" = 0 ]; then
            add sample "sample --json $f" "t sample in/$f --queries $q.0.txt --json --cache 1"
            add sample "sample what is not there $f" \
                "t sample in/$f --queries $q.1.txt; t sample in/$f --queries $q.1.txt --json"
        fi
    done
    for f in $(damaged_files); do
        q=$(basename "$f" .ptx)
        add sample "sample $f" "t sample in/$f --queries in/queries/data_${q%_*}.0.txt"
    done
}

# What there is to draw: texture, and its options.
drawn() {
    local f
    echo "demo/scene.ptx --mesh in/demo/scene.obj"
    if [ -f "$work/in/samples/teapot.ptx" ]; then echo "samples/teapot.ptx --view in/samples/teapot.json"; fi
    if [ "$quick" = 1 ]; then return 0; fi
    for f in half grey16 alpha; do echo "made/$f.ptx --mesh in/demo/scene.obj --focus creature"; done
    if [ -f "$work/in/made/cube.ptx" ]; then echo made/cube.ptx; fi
    for f in "$work"/in/samples/*.ptx; do
        f=$(basename "$f" .ptx)
        # A sample of which the old build can draw nothing has no mesh that fits.
        if [ "$f" != teapot ] && [ -f "$work/in/samples/$f.obj" ] &&
            of_build "$old" selvage render "$work/in/samples/$f.ptx" "$work/probe.png" --size 16x16 \
                --mesh "$work/in/samples/$f.obj" >/dev/null 2>&1; then
            echo "samples/$f.ptx --mesh in/samples/$f.obj"
        fi
    done
}

cases_pictures() {
    local f options options_of strategy name size=160x120
    [ "$quick" = 1 ] && size=80x60
    drawn >"$work/drawn"
    while read -r f options; do
        for strategy in $strategies; do
            name="render $f $strategy"
            # Floats of 32 bits hide nothing that a byte would round away.
            options_of="--bits 32 --size $size --strategy $strategy $options"
            add pictures "$name, anisotropy 16" "t render in/$f out.exr --aniso 16 $options_of"
            if [ "$quick" = 0 ] || [[ $f = demo/* ]]; then
                add pictures "$name, anisotropy 1" "t render in/$f out.exr --aniso 1 $options_of"
            fi
            if [ "$(info_of "$work/in/$f" data_type)" = uint8 ]; then cases_compressed; fi
            if [ "$quick" = 0 ] && [[ $f = demo/* ]]; then
                add pictures "$name, to PNG" "t render in/$f out.png --msaa 1 --shading levels --size $size \
--strategy $strategy $options; t render in/$f unlit.png --bits 16 --shading unlit --channels 1 --size 64x64 \
--strategy $strategy $options"
            fi
        done
    done <"$work/drawn"
}

# With the names of cases_pictures.
cases_compressed() {
    local aniso
    for aniso in 1 16; do
        if [ "$quick" = 0 ] || [[ $aniso = 16 && $f = demo/* ]]; then
            add pictures "$name, anisotropy $aniso --compress" \
                "t render in/$f out.exr --compress --aniso $aniso $options_of"
        fi
    done
}

cases_reference() {
    local f options size=48x32
    drawn >"$work/drawn"
    while read -r f options; do
        add reference "reference $f" \
            "t reference in/$f --samples 4 --size $size --out box.exr --error error.exr --json $options"
        add reference "reference --filter mitchell $f" \
            "t reference in/$f --samples 8 --filter mitchell --seed 3 --bits 16 --size $size --out m.exr $options"
        if [ "$quick" = 0 ]; then
            add reference "reference --convergence $f" "t reference in/$f --samples 16 --size $size --out c.exr \
--convergence study --json --quiet $options; mask_convergence study"
        fi
    done <"$work/drawn"
}

cases_report() {
    local quickly="--quick --size 96x54 --reference-frames 1 --reference-samples 4 --quiet"
    add report "compare demo/scene.ptx" "t compare in/demo/scene.ptx --mesh in/demo/scene.obj --frames 2 --msaa 1 \
$quickly --out report; mask_report report"
    if [ "$quick" = 0 ]; then
        add report "compare --compress made/alpha.ptx" "t compare in/made/alpha.ptx --mesh in/demo/scene.obj \
--compress --frames 3 --msaa 1,4 $quickly --focus creature --reference raycast,mitchell,supersampled --out report; \
mask_report report"
    fi
}

list_cases() {
    local group
    for group in help info convert images edit faces sample pictures reference report; do
        wanted "$group" || continue
        "cases_$group"
    done
}
