# shellcheck shell=sh
# What Qt needs beside OpenGL: to be sourced after bootstrap_gl.sh, whose functions it uses.
#
# Tests open their windows on Qt's platform `offscreen`, which needs the first list alone; the
# second is for windows on a screen, and asked for only where there is one. What cannot be had is
# named in one line, and all but windows works without it.

qt_packages='libglib2.0-0 libfontconfig1 libxkbcommon0 libdbus-1-3'
x11_packages='libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-image0 libxcb-render-util0 libxcb-shape0 libxcb-xkb1 libxkbcommon-x11-0'

qt_libraries='libglib-2.0.so.0 libfontconfig.so.1 libxkbcommon.so.0 libdbus-1.so.3'
x11_libraries='libxcb-cursor.so.0 libxcb-icccm.so.4 libxcb-keysyms.so.1 libxcb-image.so.0 libxcb-render-util.so.0 libxcb-shape.so.0 libxcb-xkb.so.1 libxkbcommon-x11.so.0'

install_window() {
    command -v apt-get >/dev/null || return 1
    as_root=$(root_prefix) || return 1
    say "installing $1"
    # shellcheck disable=SC2086  # a list of words
    apt_install "$as_root" $1
}

# provide_group PACKAGES LIBRARY...
provide_group() {
    packages=$1
    shift
    if system_has "$@"; then
        return
    fi
    if [ "${VRUT_LITE_GL:-}" != private ] && install_window "$packages"; then
        return
    fi
    say "going on without windows: missing are the system's packages $packages, or their like"
}

# provide_window run|test: never fails, as everything but windows works without them.
provide_window() {
    if [ "${VRUT_LITE_GL:-}" = none ]; then
        return
    fi
    # shellcheck disable=SC2086  # lists of words
    provide_group "$qt_packages" $qt_libraries
    if [ "$1" = run ] && [ -n "${DISPLAY:-}" ]; then
        # shellcheck disable=SC2086
        provide_group "$x11_packages" $x11_libraries
    fi
}
