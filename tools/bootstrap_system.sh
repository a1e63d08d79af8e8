# shellcheck shell=sh
# System libraries that pip cannot bring: OpenGL without a screen, what Qt loads, X11's part of
# Qt, what mitsuba's wheel loads, and the compiler of its fast variant. To be sourced; `say` is the
# caller's. For what is lacking, each rung is tried when the one above fails:
#
#   1. the system has the libraries;
#   2. apt-get installs them, as root or through a sudo that asks no password;
#   3. apt-get downloads them into the private folder .system, no root needed;
#   4. one line for each group says what is missing and what goes without it.
#
# VRUT_LITE_SYSTEM=private leaves out rung 2, VRUT_LITE_SYSTEM=none everything.
# .system/env, where there is one, must be sourced by whoever starts a program.

gl_packages='libegl1 libgl1'
gl_libraries='libEGL.so.1 libGL.so.1'
qt_packages='libglib2.0-0 libfontconfig1 libxkbcommon0 libdbus-1-3'
qt_libraries='libglib-2.0.so.0 libfontconfig.so.1 libxkbcommon.so.0 libdbus-1.so.3'
x11_packages='libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-image0 libxcb-render-util0 libxcb-shape0 libxcb-xkb1 libxkbcommon-x11-0'
x11_libraries='libxcb-cursor.so.0 libxcb-icccm.so.4 libxcb-keysyms.so.1 libxcb-image.so.0 libxcb-render-util.so.0 libxcb-shape.so.0 libxcb-xkb.so.1 libxkbcommon-x11.so.0'
mitsuba_packages='libatomic1'
mitsuba_libraries='libatomic.so.1'
llvm_packages='libllvm19'
llvm_libraries='libLLVM.so.19.1'

# groups_for PURPOSE: Qt's platform plugin for X11 is loaded on a screen, and tried by a test.
groups_for() {
    case $1 in
    test) echo 'gl qt x11 mitsuba' ;;
    long) echo 'gl qt x11 mitsuba llvm' ;;
    *) if [ -n "${DISPLAY:-}" ]; then echo 'gl qt x11'; else echo 'gl qt'; fi ;;
    esac
}

packages_of() {
    eval "echo \"\$$1_packages\""
}

libraries_of() {
    eval "echo \"\$$1_libraries\""
}

goes_without() {
    case $1 in
    gl) echo GL ;;
    qt) echo windows ;;
    x11) echo 'windows on a screen' ;;
    mitsuba) echo 'the path tracer' ;;
    llvm) echo "the path tracer's compiled variant" ;;
    esac
}

# The words to put before a command to run it as root, or failure.
root_prefix() {
    if [ "$(id -u)" = 0 ]; then
        return
    fi
    command -v sudo >/dev/null && sudo -n true 2>/dev/null && echo 'sudo -n'
}

# apt_update PREFIX: a failed update leaves the lists there are, which may do.
apt_update() {
    # shellcheck disable=SC2086  # the prefix is several words, or none
    $1 apt-get -qq -o Acquire::Retries=1 update >/dev/null 2>&1 || true
}

# apt_install PREFIX PACKAGE...
apt_install() {
    prefix=$1
    shift
    # shellcheck disable=SC2086  # the prefix is several words, or none
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

# private_has FOLDER LIBRARY...: whether the private folder holds each that the system lacks.
private_has() {
    private=$1
    shift
    for library in "$@"; do
        system_has "$library" || [ -n "$(find "$private/root" -name "$library" 2>/dev/null)" ] ||
            return 1
    done
}

# lacking GROUP...: the groups of which the system lacks a library.
lacking() {
    for group in "$@"; do
        # shellcheck disable=SC2046  # a list of words
        system_has $(libraries_of "$group") || echo "$group"
    done
}

# private_apt FOLDER ARGUMENTS: apt-get with lists and cache of its own, for which no root is needed.
private_apt() {
    apt_state=$1/apt
    shift
    apt-get -qq -o Dir::State::Lists="$apt_state/lists" -o Dir::Cache="$apt_state/cache" \
        -o Debug::NoLocking=1 -o Acquire::Retries=1 -o APT::Sandbox::User= "$@" 2>/dev/null
}

# packages_to_fetch FOLDER PACKAGE...: what apt would install, all that the packages need included.
# The C library stays the system's: a second one in a process ends it.
packages_to_fetch() {
    private=$1
    shift
    private_apt "$private" --simulate --no-install-recommends install "$@" |
        sed -n '/^Inst libc6 /d; s/^Inst \([^ ]*\) .*/\1/p'
}

# fetch_private FOLDER PACKAGE...: unpacks them in FOLDER/root, which is there whole or not at all.
fetch_private() {
    private=$1
    shift
    rm -rf "$private/root" "$private/unpacked" "$private/apt"
    mkdir -p "$private/apt/lists/partial" "$private/apt/cache/archives/partial" \
        "$private/unpacked" || return 1
    echo '*' >"$private/.gitignore"
    private_apt "$private" update >/dev/null || true
    needed=$(packages_to_fetch "$private" "$@")
    [ -n "$needed" ] || return 1
    # shellcheck disable=SC2086  # a list of words
    (cd "$private/apt" && private_apt "$private" download $needed >/dev/null) || return 1
    for package in "$private"/apt/*.deb; do
        dpkg -x "$package" "$private/unpacked" || return 1
    done
    rm -rf "$private/apt"
    mv "$private/unpacked" "$private/root"
}

# write_env FOLDER: the variables that lead loader, GLVND, Mesa, glcontext, PyOpenGL and Qt there.
write_env() {
    root=$1/root
    folder=$(find "$root/usr/lib" -mindepth 1 -maxdepth 1 -name '*-linux-*' 2>/dev/null | head -n 1)
    [ -n "$folder" ] || return 1
    echo "export LD_LIBRARY_PATH='$folder:$root/lib/${folder##*/}'\${LD_LIBRARY_PATH:+:\$LD_LIBRARY_PATH}" >"$1/env"
    if [ -e "$folder/libEGL.so.1" ]; then
        # PyOpenGL, finding no library by the system's ways, opens it by its bare name.
        ln -sf libEGL.so.1 "$folder/EGL"
        ln -sf libGL.so.1 "$folder/GL"
        cat >>"$1/env" <<END
export LIBGL_DRIVERS_PATH='$folder/dri'
export __EGL_VENDOR_LIBRARY_DIRS='$root/usr/share/glvnd/egl_vendor.d'
export GLCONTEXT_LINUX_LIBGL='$folder/libGL.so.1'
export GLCONTEXT_LINUX_LIBEGL='$folder/libEGL.so.1'
END
    fi
    if [ -e "$root/usr/share/fonts" ]; then
        # FONTCONFIG_SYSROOT would not do: fontconfig leaves it off the names that Qt opens.
        cat >"$1/fonts.conf" <<END
<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "urn:fontconfig:fonts.dtd">
<fontconfig>
  <dir>$root/usr/share/fonts</dir>
  <cachedir prefix="xdg">fontconfig</cachedir>
</fontconfig>
END
        echo "export FONTCONFIG_FILE='$1/fonts.conf'" >>"$1/env"
    fi
    [ ! -e "$root/usr/share/X11/xkb" ] ||
        echo "export XKB_CONFIG_ROOT='$root/usr/share/X11/xkb'" >>"$1/env"
}

# install_groups GROUP...: prints those that could not be installed; one failure costs one group.
install_groups() {
    if ! command -v apt-get >/dev/null || ! as_root=$(root_prefix); then
        echo "$*"
        return
    fi
    apt_update "$as_root"
    for group in "$@"; do
        packages=$(packages_of "$group")
        say "installing $packages"
        # shellcheck disable=SC2086  # a list of words
        apt_install "$as_root" $packages || echo "$group"
    done
}

# fetch_groups FOLDER GROUP...: into the private folder, unless it holds them all.
fetch_groups() {
    private=$1
    shift
    packages='' libraries=''
    for group in "$@"; do
        packages="$packages $(packages_of "$group")"
        libraries="$libraries $(libraries_of "$group")"
    done
    # shellcheck disable=SC2086  # lists of words
    if ! private_has "$private" $libraries; then
        command -v apt-get >/dev/null && command -v dpkg >/dev/null || return 1
        say "fetching$packages into .system, as they cannot be installed (up to 300 MB)"
        fetch_private "$private" $packages || return 1
    fi
    write_env "$private"
}

# provide_system ROOT PURPOSE: climbs down the ladder; never fails, as all else works without.
provide_system() {
    if [ "${VRUT_LITE_SYSTEM:-}" = none ]; then
        return
    fi
    # shellcheck disable=SC2046,SC2086  # lists of words
    groups=$(lacking $(groups_for "$2"))
    if [ -n "$groups" ] && [ "${VRUT_LITE_SYSTEM:-}" != private ]; then
        # shellcheck disable=SC2086
        groups=$(install_groups $groups)
    fi
    # shellcheck disable=SC2086
    if [ -n "$groups" ] && fetch_groups "$1/.system" $groups; then
        return
    fi
    rm -f "$1/.system/env"
    for group in $groups; do
        say "going on without $(goes_without "$group"): missing are the system's packages" \
            "$(packages_of "$group"), or their like"
    done
}
