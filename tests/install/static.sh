#!/bin/sh
# static.sh SOURCE SCRATCH VERSION CC CXX NM: builds the libraries as static ones below SCRATCH, looks at the names of their
# symbols, installs them, and builds and runs a program of somebody else's against them: through pkg-config and through CMake.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source=$1 scratch=$2 version=$3 cc=$4 cxx=$5 nm=$6
rm -rf "$scratch"
mkdir -p "$scratch"

cmake -S "$source" -B "$scratch/tree" -G Ninja -DCMAKE_BUILD_TYPE=None -DCMAKE_C_FLAGS=-O0 -DCMAKE_CXX_FLAGS=-O0 -DBUILD_SHARED_LIBS=OFF -DSELVAGE_COMMAND=OFF \
    -DSELVAGE_AVX2=OFF -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" >"$scratch/configure.log"
cmake --build "$scratch/tree" >"$scratch/build.log" || {
    cat "$scratch/build.log"
    exit 1
}
cmake --install "$scratch/tree" --prefix "$scratch/first" >"$scratch/install.log"
mv "$scratch/first" "$scratch/prefix"
prefix=$scratch/prefix
libraries=$(dirname "$(find "$prefix" -name 'libselvage.a' | head -n 1)")
rm -rf "$scratch/tree"

# Archives hide nothing: what could meet a program's own names is slv_ or slvi_, or a C++ name in a namespace of ours or made
# of the C++ library's templates, of which linkers keep one.
"$nm" -g --defined-only "$libraries"/*.a 2>/dev/null | awk 'NF == 3 && $3 !~ /^slvi?_/ && $3 !~ /^_ZN[0-9]*slvi_/ &&
    !($2 ~ /^[VWu]$/ && $3 ~ /^(_Z|DW\.ref\.)/) { print "a strange name: " $3; found = 1 } END { exit found }'

# Shared libraries of the same names may lie where the system looks: a program that ran here without ours needs none.
export PKG_CONFIG_PATH="$libraries/pkgconfig"
for package in selvage selvage-gl selvage-bake selvage-paint; do
    pkg-config --exact-version "$version" "$package"
done
# shellcheck disable=SC2046,SC2086
$cc -std=c17 -Wall -Wextra -Wpedantic -Werror "$here/consumer/main.c" -o "$scratch/with-pkg-config" \
    $(pkg-config --static --cflags --libs selvage-bake selvage-gl)
"$scratch/with-pkg-config"
# shellcheck disable=SC2046,SC2086
$cc -std=c17 "$here/consumer/base.c" -o "$scratch/base-with-pkg-config" $(pkg-config --static --cflags --libs selvage)
"$scratch/base-with-pkg-config"

for components in "selvage" "gl;bake"; do
    rm -rf "$scratch/build"
    cmake -S "$here/consumer" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
        -DCMAKE_CXX_COMPILER="$cxx" -DCOMPONENTS="$components" >"$scratch/configure.log"
    cmake --build "$scratch/build" >"$scratch/build.log"
    "$scratch/build/consumer"
done
rm -rf "$scratch"
