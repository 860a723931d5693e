#!/bin/sh
# consumer.sh BUILD SCRATCH VERSION CC FLAGS: installs BUILD below SCRATCH, moves it, and builds and runs a program of somebody
# else's against what lies there: once through pkg-config, once through CMake.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$1 scratch=$2 version=$3 cc=$4 flags=${5:-}
rm -rf "$scratch"
mkdir -p "$scratch"

# Installed packages get moved around: nothing may remember where they were first put.
cmake --install "$build" --prefix "$scratch/first" >"$scratch/install.log"
mv "$scratch/first" "$scratch/prefix"
prefix=$scratch/prefix
libraries=$(dirname "$(find "$prefix" -name 'libselvage.so' | head -n 1)")
test -f "$libraries/pkgconfig/selvage.pc"
test -f "$libraries/cmake/Selvage/SelvageConfig.cmake"

# The shaders' text serves by itself, for each strategy that it names.
lookups=$prefix/share/selvage/selvage_sample.glsl
for strategy in $(sed -n 's|^//   \(SLV_STRATEGY_[A-Z_]*\)$|\1|p' "$lookups"); do
    printf '#version 450 core\n#define %s\n' "$strategy" | cat - "$lookups" "$here/consumer/lookup.frag" \
        >"$scratch/$strategy.frag"
done
glslangValidator "$scratch"/SLV_STRATEGY_*.frag >"$scratch/shaders.log" || {
    cat "$scratch/shaders.log"
    exit 1
}

export PKG_CONFIG_PATH="$libraries/pkgconfig"
for package in selvage selvage-gl selvage-bake; do
    pkg-config --exact-version "$version" "$package"
    test -d "$(pkg-config --variable=includedir "$package")/selvage"
done
# shellcheck disable=SC2046,SC2086
$cc -std=c17 -Wall -Wextra -Wpedantic -Werror $flags "$here/consumer/main.c" -o "$scratch/with-pkg-config" \
    $(pkg-config --cflags --libs selvage-bake)
LD_LIBRARY_PATH="$libraries" "$scratch/with-pkg-config"

cmake -S "$here/consumer" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
    -DCMAKE_C_FLAGS="$flags" >"$scratch/configure.log"
cmake --build "$scratch/build" >"$scratch/build.log"
"$scratch/build/consumer"

# The command finds its libraries without help from the environment.
"$prefix/bin/selvage" --version
rm -rf "$scratch"
