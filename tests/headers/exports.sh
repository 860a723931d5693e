#!/bin/sh
# exports.sh NM LIBRARY...: fails if a library exports anything but public functions.
set -eu
nm=$1
shift
status=0
for library; do
    if "$nm" -DC --defined-only "$library" | awk '$3 !~ /^slv_/' | grep .; then
        echo "$library exports more than slv_*"
        status=1
    fi
done
exit $status
