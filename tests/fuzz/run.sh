#!/bin/bash
# tests/fuzz/run.sh NAME [SECONDS]: looks for inputs that a target does not survive, from its corpus on. What it learns
# stays in build/fuzz/corpus, what it finds is in build/fuzz/found.
set -euo pipefail
cd "$(dirname "$0")/../.."
name=${1:?which target? one of tests/fuzz/*.c} seconds=${2:-600}
mkdir -p "build/fuzz/corpus/$name" build/fuzz/found
export UBSAN_OPTIONS=print_stacktrace=1
exec build/fuzz/bin/"fuzz_$name" -max_total_time="$seconds" -timeout=5 -malloc_limit_mb=128 -rss_limit_mb=2048 \
    -max_len=65536 -print_final_stats=1 -artifact_prefix="build/fuzz/found/$name-" \
    "build/fuzz/corpus/$name" "tests/fuzz/corpus/$name" tests/conformance/data
