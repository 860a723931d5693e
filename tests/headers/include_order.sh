#!/bin/sh
# include_order.sh ROOT: checks every source file below ROOT.
# include_order.sh --self-test SCRATCH: proves that the check refuses what it should, on trees made for the purpose.
set -eu
here=$(cd "$(dirname "$0")" && pwd)

check() {
    (cd "$1" && find . \( -name '*.c' -o -name '*.h' -o -name '*.cpp' \) \
        \( -path './runtime/*' -o -path './bake/*' -o -path './tools/*' -o -path './assets/*' \) |
        sed 's|^\./||' | sort | xargs awk -f "$here/include_order.awk" "$here/order.txt")
}

failures=0
expect() { # accepted|refused FILE LINE
    rm -rf "$scratch"
    mkdir -p "$scratch/$(dirname "$2")" "$scratch/bake/include/selvage"
    : >"$scratch/bake/include/selvage/bake.h"
    printf '#include <string.h>\n%s\n' "$3" >"$scratch/$2"
    if check "$scratch" >"$scratch/output"; then found=accepted; else found=refused; fi
    if [ "$found" != "$1" ]; then
        echo "$2 with $3: $found, but should be $1"
        failures=$((failures + 1))
    elif [ "$1" = refused ] && ! grep -q "^$2:2: " "$scratch/output"; then
        echo "$2 with $3: refused, but without naming the line:"
        cat "$scratch/output"
        failures=$((failures + 1))
    fi
}

if [ "$1" != --self-test ]; then
    check "$1"
    exit
fi
scratch=$2
expect accepted runtime/base/a.c '#include "base/log.h"'
expect accepted runtime/base/a.c '#include <selvage/half.h>'
expect refused runtime/base/a.c '#include "mesh/mesh_data.h"'
expect refused runtime/base/a.c '#include <selvage/mesh.h>'
expect refused runtime/base/a.c '#include <selvage/unheard_of.h>'
expect refused runtime/image/a.c '#include <selvage/ptx.h>'
expect accepted runtime/mesh/a.cpp '#include <opensubdiv/far/error.h>'
expect accepted runtime/mesh/a.c '#include <selvage/surface.h>'
expect accepted runtime/mesh/a.c '#include <selvage/tessellation.h>'
expect refused runtime/mesh/a.c '#include <selvage/texture.h>'
expect refused runtime/mesh/a.c '#include "texture/texture_data.h"'
expect accepted runtime/texture/a.c '#include "adjacency/adjacency_data.h"'
expect refused runtime/texture/a.c '#include <selvage/ptx.h>'
expect refused runtime/texture/a.c '#include "../ptx/format/ptx_file.h"'
expect accepted runtime/ptx/a.c '#include "texture/texture_data.h"'
expect refused runtime/ptx/a.c '#include "image/png.h"'
expect refused runtime/ptx/a.c '  #  include  <selvage/gl_context.h>'
expect refused runtime/ptx/a.c '#include <GL/glcorearb.h>'
expect refused runtime/ptx/a.c '#include <opensubdiv/far/error.h>'
expect refused runtime/filter/a.c '#include "gl/store/store.h"'
expect accepted runtime/gl/a.c '#include <EGL/egl.h>'
expect accepted runtime/gl/a.c '#include "ptx/format/ptx_file.h"'
expect accepted runtime/gl/a.c '#include <selvage/tessellation.h>'
expect refused runtime/gl/a.c '#include <embree3/rtcore.h>'
expect refused runtime/gl/a.c '#include <selvage/bake.h>'
expect refused runtime/gl/a.c '#include <selvage/selvage.h>'
expect accepted bake/a.c '#include "base/parallel.h"'
expect accepted bake/a.c '#include <selvage/ptx.h>'
expect accepted bake/a.c '#include <embree4/rtcore.h>'
expect accepted bake/a.c '#include "adjacency/edge.h"'
expect refused bake/a.c '#include "adjacency/adjacency_data.h"'
expect refused bake/a.c '#include "mesh/mesh_data.h"'
expect refused bake/a.c '#include <selvage/gl_context.h>'
expect accepted tools/a.c '#include "cli.h"'
expect accepted tools/a.c '#include <selvage/bake.h>'
expect refused tools/a.c '#include "base/log.h"'
expect refused tools/a.c '#include "info/info.h"'
expect accepted tools/info/a.c '#include "info/info.h"'
expect accepted tools/info/a.c '#include "verbs.h"'
expect accepted tools/info/a.c '#include "command/cli.h"'
expect refused tools/info/a.c '#include "convert/convert.h"'
expect refused tools/command/a.c '#include "info/info.h"'
expect refused tools/command/a.c '#include "verbs.h"'
expect refused tools/command/a.c '#include "compare/engine/report.h"'
expect accepted tools/compare/engine/a.c '#include "compare/engine/report.h"'
expect accepted tools/compare/engine/a.c '#include "command/output.h"'
expect refused tools/compare/engine/a.c '#include "compare/report/report_page.h"'
expect refused tools/compare/engine/a.c '#include "compare/compare.h"'
expect accepted tools/compare/report/a.c '#include "compare/engine/report.h"'
expect refused tools/compare/report/a.c '#include "compare/compare.h"'
expect accepted tools/compare/a.c '#include "compare/report/report_page.h"'
expect accepted tools/compare/a.c '#include "compare/compare.h"'
expect accepted bake/rays/a.c '#include "rays/reference_data.h"'
expect refused bake/rays/a.c '#include "exchange/index.h"'
expect refused bake/transfer/a.c '#include "surface/painter_data.h"'
expect accepted bake/paint/brush/a.c '#include "surface/painter_data.h"'
expect refused bake/paint/surface/a.c '#include "brush/path.h"'
expect refused bake/paint/canvas/a.c '#include "brush/path.h"'
expect refused bake/paint/brush/a.c '#include "exchange/index.h"'
expect accepted bake/paint/surface/a.c '#include "rays/embree.h"'
expect refused bake/paint/surface/a.c '#include "rays/look.h"'
expect refused assets/a.c '#include "base/log.h"'
expect accepted runtime/include/selvage/ptx.h '#include <selvage/texture.h>'
expect accepted runtime/include/selvage/border.h '#include <selvage/texture.h>'
expect accepted runtime/include/selvage/gl_texture.h '#include <selvage/gl_context.h>'
expect accepted runtime/include/selvage/selvage.h '#include <selvage/gl_context.h>'
expect refused runtime/include/selvage/texture.h '#include <selvage/border.h>'
expect refused runtime/include/selvage/half.h '#include <selvage/adjacency.h>'
expect refused runtime/include/selvage/image.h '#include <selvage/gl_context.h>'
expect refused runtime/include/selvage/mesh.h '#include "base/log.h"'
expect refused runtime/include/selvage/mesh.h '#include <selvage/nonsense.h>'
expect refused bake/include/selvage/bake.h '#include <selvage/gl_context.h>'
rm -rf "$scratch"
exit "$failures"
