#!/bin/sh
# parts.sh SOURCE SCRATCH CC CXX: configures libselvage alone, which asks for nothing that only the other libraries and the
# command need.
set -eu
source=$1 scratch=$2 cc=$3 cxx=$4
rm -rf "$scratch"
mkdir -p "$scratch"
cmake -S "$source" -B "$scratch" -DSELVAGE_GL=OFF -DSELVAGE_BAKE=OFF -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" \
    >"$scratch/configure.log"
if grep -iE 'embree|jansson|squish|opengl' "$scratch/CMakeCache.txt"; then
    echo "libselvage needs none of these"
    exit 1
fi
rm -rf "$scratch"
