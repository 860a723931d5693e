#!/bin/sh
# consumer.sh BUILD SCRATCH VERSION CC FLAGS: installs BUILD below SCRATCH, moves it, and builds and runs programs of somebody
# else's against what lies there: through pkg-config and through CMake.
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

# So does the one for coordinates that go round, in both stages.
for stage in vert frag; do
    define=$(test "$stage" = vert || echo '#define SLV_WRAP_FRAGMENT')
    printf '#version 450 core\n%s\n' "$define" | cat - "$prefix/share/selvage/selvage_wrap.glsl" "$here/consumer/wrap.$stage" \
        >"$scratch/wrap.$stage"
done
glslangValidator -l "$scratch"/wrap.vert "$scratch"/wrap.frag >"$scratch/shaders.log" || {
    cat "$scratch/shaders.log"
    exit 1
}

export PKG_CONFIG_PATH="$libraries/pkgconfig"
for package in selvage selvage-gl selvage-bake selvage-paint; do
    pkg-config --exact-version "$version" "$package"
    test -d "$(pkg-config --variable=includedir "$package")/selvage"
done
# shellcheck disable=SC2046,SC2086
$cc -std=c17 -Wall -Wextra -Wpedantic -Werror $flags "$here/consumer/main.c" -o "$scratch/with-pkg-config" \
    $(pkg-config --cflags --libs selvage-bake selvage-gl)
LD_LIBRARY_PATH="$libraries" "$scratch/with-pkg-config"

# The first library by itself needs nothing of the others: not to be found, not to be linked and not to be run.
mkdir "$scratch/others"
mv "$libraries"/libselvage-* "$scratch/others"
for components in selvage "gl;bake"; do
    rm -rf "$scratch/build"
    cmake -S "$here/consumer" -B "$scratch/build" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
        -DCMAKE_C_FLAGS="$flags" -DCOMPONENTS="$components" >"$scratch/configure.log"
    cmake --build "$scratch/build" >"$scratch/build.log"
    "$scratch/build/consumer"
    test "$components" = selvage || break
    if LD_LIBRARY_PATH="$libraries" ldd "$scratch/build/consumer" | grep -E 'embree|jansson|squish|libGL|libEGL|OSMesa'; then
        echo "the first library needs these"
        exit 1
    fi
    mv "$scratch/others"/* "$libraries"
done
# A component that there is not is missed.
if cmake -S "$here/consumer" -B "$scratch/missing" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" \
    -DCOMPONENTS="sculpt" >"$scratch/configure.log" 2>&1; then
    echo "a component 'sculpt' was found"
    exit 1
fi

# The command finds its libraries without help from the environment.
"$prefix/bin/selvage" --version
rm -rf "$scratch"
