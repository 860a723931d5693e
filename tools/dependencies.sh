#!/bin/sh
# Makes sure that what Selvage is built with is installed: says what is missing, and installs it with apt-get where there
# is one. Elsewhere it prints the list and leaves the rest to whoever runs it. With the argument `tests` it also sees to
# what tests take: a display without a screen and events for it (Xvfb, xdotool), universal-ctags, ImageMagick, OpenEXR's
# tools, MyPaint's brushes, Open MPI, a second OpenGL driver (Mesa's zink over its software Vulkan), and a browser, in which one
# of them opens a report and makes do without where there is none to be had. With `ci` it sees to all that .ci/run takes:
# that, and clang with its formatter.
set -eu

packages="cmake ninja-build gcc g++ pkg-config libosd-dev libopenexr-dev libpng-dev libdeflate-dev libjansson-dev
libembree-dev libmypaint-dev libsquish-dev libgl-dev libegl-dev libegl1 libegl-mesa0 libgl1-mesa-dri libosmesa6 glslang-tools"
# Of the window, which is left out where they are not to be had.
window="libgtk-4-dev libepoxy-dev"
case "${1:-}" in
tests) packages="$packages libopenmpi-dev openmpi-bin universal-ctags imagemagick openexr mypaint-brushes xvfb xdotool mesa-vulkan-drivers" ;;
ci) packages="$packages libopenmpi-dev openmpi-bin universal-ctags imagemagick openexr mypaint-brushes xvfb xdotool mesa-vulkan-drivers make clang clang-format-14" ;;
"") ;;
*)
    echo "dependencies.sh: '$1': expected nothing, tests or ci" >&2
    exit 2
    ;;
esac

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
    echo "No apt-get here. Please see to it that these Debian packages' counterparts are installed:"
    for package in $packages $window; do echo "  $package"; done
    exit 0
fi

browser=""
if [ -n "${1:-}" ] && ! command -v chromium >/dev/null && ! command -v chromium-browser >/dev/null &&
    ! command -v google-chrome >/dev/null; then
    browser=chromium
fi

missing_of() {
    for package in "$@"; do
        status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
        [ "$status" = installed ] || printf ' %s' "$package"
    done
}
# shellcheck disable=SC2086
missing=$(missing_of $packages)
# shellcheck disable=SC2086
window=$(missing_of $window)
if [ -z "$missing$window$browser" ]; then
    exit 0
fi

if [ "$(id -u)" = 0 ]; then
    as_root=""
elif command -v sudo >/dev/null; then
    as_root=sudo
else
    [ -z "$missing" ] && exit 0
    echo "These packages are missing, and installing them takes root or sudo:$missing" >&2
    exit 1
fi
echo "Installing:$missing$window${browser:+ $browser}"
$as_root env DEBIAN_FRONTEND=noninteractive apt-get update -q
# shellcheck disable=SC2086
[ -z "$missing" ] || $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
[ -z "$browser" ] || $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $browser ||
    echo "No browser could be installed: the report is tested without."
# shellcheck disable=SC2086
[ -z "$window" ] || $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $window ||
    echo "GTK 4 could not be installed: selvage studio is left out."
