#!/bin/sh
# Sets up what `make run` and `make test` need, in the checkout: .venv with the project, the
# laboratory and their packages, then the system's libraries for GL, windows and mitsuba
# (bootstrap_system.sh). Quick when there is nothing to do.
#
#   tools/bootstrap.sh run|test|lint|long|docs|page
#
# Where npm is, all but docs also build the script of `vrut-lite share`'s pages; `page` builds it
# alone, and says so where it cannot.
#
# PYTHON names the interpreter to make .venv with; without it the first Python 3.11 or newer.
# VRUT_LITE_SYSTEM is explained in bootstrap_system.sh.
set -eu

root=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)
python=$root/.venv/bin/python

say() {
    printf 'vrut_lite: %s\n' "$*" >&2
}

is_new_enough() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null
}

find_python() {
    for candidate in ${PYTHON:-python3 python3.14 python3.13 python3.12 python3.11}; do
        if is_new_enough "$candidate"; then
            echo "$candidate"
            return
        fi
    done
    say "no Python 3.11 or newer found: install one, or name it as in PYTHON=/path/to/python3 make run"
    return 1
}

# Debian splits venv's half, ensurepip, from Python.
install_venv_module() {
    package=$("$1" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
    if ! as_root=$(root_prefix) || ! command -v apt-get >/dev/null; then
        say "$1 cannot make virtual environments: install $package"
        return 1
    fi
    say "installing $package"
    apt_update "$as_root"
    apt_install "$as_root" "$package" || {
        say "apt-get could not install $package, without which $1 makes no virtual environment"
        return 1
    }
}

make_venv() {
    # pip comes last, so a .venv that has it is whole.
    if [ -x "$root/.venv/bin/pip" ] && is_new_enough "$python"; then
        return
    fi
    base=$(find_python)
    "$base" -c 'import ensurepip, venv' 2>/dev/null || install_venv_module "$base"
    say "making .venv with $("$base" --version)"
    "$base" -m venv "$root/.venv"
}

# What an installation depends on; a stamp holds it in full, so nothing can be mistaken for it.
installation_key() {
    echo "$root"
    "$python" -c 'import sys; print(sys.version)'
    cat "$root/pyproject.toml" "$root/lab/pyproject.toml"
}

# is_installed PURPOSE KEY
is_installed() {
    stamp=$root/.venv/installed-for-$1
    [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$2" ]
}

# Editable, so that a change of the sources needs no installation, only one of pyproject.toml. What is
# never imported is never compiled: that saves half of the time. uv takes a third of pip's and is
# told pip's index and certificates; where uv is not to be had or fails, pip says what is wrong.
# install_editable EXTRAS LAB_EXTRAS
install_editable() {
    # Entry points of an earlier build in the checkout would be found before the installed ones.
    rm -rf "$root"/*.egg-info "$root"/lab/*.egg-info
    if "$python" -m pip install --quiet --quiet --no-compile 'uv>=0.8,<1' 2>/dev/null; then
        index=${PIP_INDEX_URL:-$("$python" -m pip config get global.index-url 2>/dev/null || true)}
        certificates=${SSL_CERT_FILE:-${PIP_CERT-}}
        env ${certificates:+"SSL_CERT_FILE=$certificates"} "$python" -m uv pip install --quiet \
            --python "$python" ${index:+--default-index} ${index:+"$index"} \
            --editable "$root$1" --editable "$root/lab$2" 2>/dev/null && return
    fi
    "$python" -m pip install --quiet --quiet --no-compile \
        --editable "$root$1" --editable "$root/lab$2"
}

# install_packages PURPOSE EXTRAS LAB_EXTRAS
# What suffices to lint suffices to test, and that to run.
install_packages() {
    key=$(installation_key)
    case $1 in
    run) sufficient='run test lint long' ;;
    test) sufficient='test lint long' ;;
    *) sufficient=$1 ;;
    esac
    for purpose in $sufficient; do
        if is_installed "$purpose" "$key"; then
            return
        fi
    done
    say "installing Python packages into .venv (the first time takes a minute or more)"
    if install_editable "$2" "$3"; then
        printf '%s\n' "$key" >"$root/.venv/installed-for-$1"
    elif [ "$1" = test ]; then
        # Leaves no stamp, so that the next time tries again.
        say "trying without mitsuba and ifcopenshell: the tests that need them will be skipped"
        install_editable '[app,test]' '[test]'
    else
        return 1
    fi
}

has_npm() {
    command -v npm >/dev/null && command -v node >/dev/null
}

# The script of shared pages, modules/share/built/page.js, of our sources and npm's packages. They
# are installed and bundled in .page, so that the package's folder holds nothing else.
# build_page TYPES
build_page() {
    from=$root/modules/share/page built=$root/modules/share/built work=$root/.page
    key=$(cat "$from"/package.json "$from"/build.mjs "$from"/src/*.js)
    stamp=$work/built-of
    mkdir -p "$work"
    if [ -f "$built/page.js" ] && [ -f "$stamp" ] && [ "$(cat "$stamp")" = "$key" ]; then
        [ "$1" = no ] || [ -d "$work/node_modules/typescript" ] || install_types
        return
    fi
    say "bundling the script of shared pages"
    rm -rf "$work/src"
    cp -R "$from/." "$work/"
    (cd "$work" && npm install --silent --no-audit --no-fund --no-package-lock && node build.mjs "$built") ||
        return 1
    [ "$1" = no ] || install_types
    printf "%s\n" "$key" >"$stamp"
}

install_types() {
    (cd "$work" && npm install --silent --no-audit --no-fund --no-package-lock --no-save \
        typescript@7.0.2 @types/three@0.187.0) || say "without npm's typescript the page's types are not checked"
}

# shellcheck source=tools/bootstrap_system.sh
. "$root/tools/bootstrap_system.sh"

case ${1-} in
run) extras='[app]' lab_extras= ;;
test) extras='[app,test,ref,ifc]' lab_extras='[test]' ;;
lint) extras='[app,test,ref,ifc,lint]' lab_extras='[test]' ;;
long) extras='[app,test,ref,ifc,usd,film]' lab_extras='[test,radiance,truth]' ;;
docs) extras='[app,docs]' lab_extras= ;;
page)
    if ! has_npm; then
        say "the script of shared pages needs Node.js with npm (Debian: apt-get install nodejs npm)"
        exit 1
    fi
    build_page no
    exit
    ;;
*)
    say "usage: tools/bootstrap.sh run|test|lint|long|docs|page"
    exit 2
    ;;
esac
make_venv
install_packages "$1" "$extras" "$lab_extras"
# Without it all else works, and `vrut-lite share` says what it needs.
if has_npm && [ "$1" != docs ]; then
    types=no
    [ "$1" != long ] || types=yes
    build_page $types || say "could not build the script of shared pages, which \`vrut-lite share\` needs"
fi
# Linters load no library of the system's, nor does the documentation.
[ "$1" = lint ] || [ "$1" = docs ] || provide_system "$root" "$1"
