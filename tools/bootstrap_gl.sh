# shellcheck shell=sh
# GL without a screen: finds or fetches libEGL and libGL with Mesa's software renderer. To be
# sourced; `say` is the caller's. Each rung is tried when the one above is not to be had:
#
#   1. the system has the libraries;
#   2. apt-get installs them, as root or through a sudo that asks no password;
#   3. apt-get downloads them into the private folder .gl, no root needed (230 MB);
#   4. one line says what is missing, and everything but GL works.
#
# VRUT_LITE_GL=private leaves out rung 2, VRUT_LITE_GL=none everything.
# .gl/env, where there is one, must be sourced by whoever starts a program that draws.

gl_packages='libegl1 libgl1'

# The words to put before a command to run it as root, or failure.
root_prefix() {
    if [ "$(id -u)" = 0 ]; then
        return
    fi
    command -v sudo >/dev/null && sudo -n true 2>/dev/null && echo 'sudo -n'
}

# apt_install PREFIX PACKAGE...: update and install; a failed update leaves the lists there are.
apt_install() {
    prefix=$1
    shift
    # shellcheck disable=SC2086  # the prefix is several words, or none
    $prefix apt-get -qq -o Acquire::Retries=1 update >/dev/null 2>&1 || true
    # shellcheck disable=SC2086
    $prefix env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=60 install \
        --yes --no-install-recommends "$@" >/dev/null 2>&1
}

# system_has LIBRARY...: whether the loader knows them all.
system_has() {
    # /sbin, where Debian keeps ldconfig, is seldom on a user's path.
    known=$(PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null) || return 1
    for library in "$@"; do
        case $known in
        *"$library "*) ;;
        *) return 1 ;;
        esac
    done
}

# private_apt FOLDER ARGUMENTS: apt-get with lists and cache of its own, for which no root is needed.
private_apt() {
    apt_state=$1/apt
    shift
    apt-get -qq -o Dir::State::Lists="$apt_state/lists" -o Dir::Cache="$apt_state/cache" \
        -o Debug::NoLocking=1 -o Acquire::Retries=1 -o APT::Sandbox::User= "$@" 2>/dev/null
}

# packages_lacking FOLDER: what apt would install, all that the packages need included. The C
# library stays the system's: a second one in a process ends it.
packages_lacking() {
    # shellcheck disable=SC2086  # a list of words
    private_apt "$1" --simulate --no-install-recommends install $gl_packages |
        sed -n '/^Inst libc6 /d; s/^Inst \([^ ]*\) .*/\1/p'
}

# fetch_private FOLDER: those packages, unpacked in FOLDER/root, which is there whole or not at all.
fetch_private() {
    rm -rf "$1/root" "$1/unpacked" "$1/apt"
    mkdir -p "$1/apt/lists/partial" "$1/apt/cache/archives/partial" "$1/unpacked" || return 1
    echo '*' >"$1/.gitignore"
    private_apt "$1" update >/dev/null || true
    needed=$(packages_lacking "$1")
    [ -n "$needed" ] || return 1
    # shellcheck disable=SC2086  # a list of words
    (cd "$1/apt" && private_apt "$1" download $needed >/dev/null) || return 1
    for package in "$1"/apt/*.deb; do
        dpkg -x "$package" "$1/unpacked" || return 1
    done
    rm -rf "$1/apt"
    mv "$1/unpacked" "$1/root"
}

# write_gl_env FOLDER: the variables that lead loader, GLVND, Mesa, glcontext and PyOpenGL there.
write_gl_env() {
    egl=$(find "$1/root" -name libEGL.so.1 2>/dev/null | head -n 1)
    [ -n "$egl" ] || return 1
    libraries=${egl%/*}
    name=${libraries##*/}
    # PyOpenGL, finding no library by the system's ways, opens it by its bare name.
    ln -sf libEGL.so.1 "$libraries/EGL"
    ln -sf libGL.so.1 "$libraries/GL"
    cat >"$1/env" <<END
export LD_LIBRARY_PATH='$libraries:$1/root/lib/$name'\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}
export LIBGL_DRIVERS_PATH='$libraries/dri'
export __EGL_VENDOR_LIBRARY_DIRS='$1/root/usr/share/glvnd/egl_vendor.d'
export GLCONTEXT_LINUX_LIBGL='$libraries/libGL.so.1'
export GLCONTEXT_LINUX_LIBEGL='$libraries/libEGL.so.1'
END
}

install_gl() {
    command -v apt-get >/dev/null || return 1
    as_root=$(root_prefix) || return 1
    say "installing $gl_packages"
    # shellcheck disable=SC2086  # a list of words
    apt_install "$as_root" $gl_packages
}

provide_private_gl() {
    if write_gl_env "$1/.gl"; then
        return
    fi
    command -v apt-get >/dev/null && command -v dpkg >/dev/null || return 1
    say "fetching $gl_packages into .gl, as they cannot be installed (230 MB)"
    fetch_private "$1/.gl" && write_gl_env "$1/.gl"
}

# provide_gl ROOT: climb down the ladder; never fails, as everything but GL works without it.
provide_gl() {
    if [ "${VRUT_LITE_GL:-}" = none ]; then
        return
    fi
    if system_has libEGL.so.1 libGL.so.1; then
        rm -f "$1/.gl/env"
        return
    fi
    if [ "${VRUT_LITE_GL:-}" != private ] && install_gl; then
        rm -f "$1/.gl/env"
        return
    fi
    provide_private_gl "$1" ||
        say "going on without GL: missing are the system's packages $gl_packages, or their like"
}
