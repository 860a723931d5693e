#!/bin/sh
# Makes sure that what Selvage is built with is installed: says what is missing, and installs it with apt-get where there
# is one. Elsewhere it prints the list and leaves the rest to whoever runs it.
set -eu

packages="cmake ninja-build gcc g++ pkg-config libosd-dev libopenexr-dev libpng-dev libdeflate-dev libjansson-dev
libembree-dev libsquish-dev libgl-dev libegl-dev libegl1 libegl-mesa0 libgl1-mesa-dri libosmesa6 glslang-tools"

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "No apt-get here. Please see to it that these Debian packages' counterparts are installed:"
    for package in $packages; do echo "  $package"; done
    exit 0
fi

missing=""
for package in $packages; do
    status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
    [ "$status" = installed ] || missing="$missing $package"
done
if [ -z "$missing" ]; then
    exit 0
fi

if [ "$(id -u)" = 0 ]; then
    as_root=""
elif command -v sudo >/dev/null; then
    as_root=sudo
else
    echo "These packages are missing, and installing them takes root or sudo:$missing" >&2
    exit 1
fi
echo "Installing:$missing"
$as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
