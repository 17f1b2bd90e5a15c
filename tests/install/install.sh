#!/usr/bin/env bash
# Installs a build into a prefix of its own, checks what is there, builds the consumers by find_package and by
# pkg-config and runs them; then moves the prefix and does it again.
#
# usage: install.sh BUILD_DIRECTORY WORK_DIRECTORY, with CMAKE, GENERATOR, CC, CXX, PKG_CONFIG, FRM_PYTHON, LIBDIR,
# VERSION, HAS_PROGRAM and HAS_BAKE (1 or 0) in the environment; tests/install/CMakeLists.txt sets them.
set -euo pipefail

build=$1
work=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mesh=$here/../../samples/meshes/box.glb

fail() {
    echo "wrong: $*" >&2
    exit 1
}

check_files() {
    local prefix=$1 file
    local files=(include/frm.h "$LIBDIR/libfrm.so" "$LIBDIR/libfrm.so.${VERSION%%.*}" "$LIBDIR/libfrm.so.$VERSION"
        "$LIBDIR/cmake/frm/frmConfig.cmake" "$LIBDIR/cmake/frm/frmConfigVersion.cmake"
        "$LIBDIR/cmake/frm/frmTargets.cmake" "$LIBDIR/pkgconfig/frm.pc")
    [ "$HAS_BAKE" != 1 ] || files+=(include/frm_bake.h "$LIBDIR/libfrm_bake.so" "$LIBDIR/libfrm_bake.so.${VERSION%%.*}"
        "$LIBDIR/libfrm_bake.so.$VERSION" "$LIBDIR/pkgconfig/frm_bake.pc")
    [ "$HAS_PROGRAM" != 1 ] || files+=(bin/frm share/frm/python/frm/__init__.py share/frm/python/frm/report.py)
    for file in "${files[@]}"; do
        [ -e "$prefix/$file" ] || fail "$file is not installed"
    done
    # Nothing that belongs to the build: no path of this machine in what is meant to be moved.
    if grep -rlF -e "$build" -e "$work" "$prefix/$LIBDIR/cmake" "$prefix/$LIBDIR/pkgconfig" "$prefix/include"; then
        fail "the files above name the directory of the build or of the installation"
    fi
}

# The program runs from where it is installed, without help from LD_LIBRARY_PATH, and the binding with the library.
check_program() {
    local prefix=$1 output
    [ "$HAS_PROGRAM" = 1 ] || return 0
    output=$(env -u LD_LIBRARY_PATH "$prefix/bin/frm" --version) || fail "bin/frm --version does not run"
    [[ $output = *"$VERSION"* ]] || fail "bin/frm --version says '$output', not $VERSION"
    output=$(PYTHONDONTWRITEBYTECODE=1 PYTHONPATH="$prefix/share/frm/python" FRM_LIBRARY="$prefix/$LIBDIR/libfrm.so" \
        "$FRM_PYTHON" -c 'import frm; print(frm.__file__)') || fail "the installed binding does not load"
    [ "$output" = "$prefix/share/frm/python/frm/__init__.py" ] || fail "another binding was loaded: $output"
}

run_consumer() {
    local prefix=$1 program=$2 output
    shift 2
    output=$(LD_LIBRARY_PATH="$prefix/$LIBDIR" "$program" "$@") || fail "$program failed: $output"
    [ "$output" = "frm $VERSION" ] || fail "$program printed '$output', not 'frm $VERSION'"
    echo "ok: $program"
}

by_find_package() {
    local prefix=$1 out=$2 language
    if ! { "$CMAKE" -S "$here/consumer" -B "$out" -G "$GENERATOR" -DCMAKE_C_COMPILER="$CC" \
        -DCMAKE_CXX_COMPILER="$CXX" -DCMAKE_PREFIX_PATH="$prefix" -DFRM_VERSION_WANTED="${VERSION%.*}" \
        -DFRM_HAS_BAKE="$HAS_BAKE" &&
        "$CMAKE" --build "$out"; } >"$out.log" 2>&1; then
        cat "$out.log"
        fail "the consumer by find_package does not build"
    fi
    for language in c cpp; do
        run_consumer "$prefix" "$out/consumer_$language"
    done
    [ "$HAS_BAKE" != 1 ] || run_consumer "$prefix" "$out/consumer_bake" "$mesh"
}

by_pkg_config() {
    local prefix=$1 out=$2 cflags libs
    mkdir -p "$out"
    # Only the installed file is seen: a consumer of the shared library needs no zstd headers.
    export PKG_CONFIG_LIBDIR="$prefix/$LIBDIR/pkgconfig"
    [ "$("$PKG_CONFIG" --modversion frm)" = "$VERSION" ] || fail "frm.pc has another version"
    read -ra cflags <<<"$("$PKG_CONFIG" --cflags frm)"
    read -ra libs <<<"$("$PKG_CONFIG" --libs frm)"
    "$CC" -std=c99 "${cflags[@]}" "$here/consumer/consumer.c" -o "$out/consumer_c" "${libs[@]}"
    "$CXX" -std=c++11 "${cflags[@]}" "$here/consumer/consumer.cpp" -o "$out/consumer_cpp" "${libs[@]}"
    if [ "$HAS_BAKE" = 1 ]; then
        read -ra cflags <<<"$("$PKG_CONFIG" --cflags frm_bake)"
        read -ra libs <<<"$("$PKG_CONFIG" --libs frm_bake)"
        "$CC" -std=c99 "${cflags[@]}" "$here/consumer/consumer_bake.c" -o "$out/consumer_bake" "${libs[@]}"
        run_consumer "$prefix" "$out/consumer_bake" "$mesh"
    fi
    unset PKG_CONFIG_LIBDIR
    run_consumer "$prefix" "$out/consumer_c"
    run_consumer "$prefix" "$out/consumer_cpp"
}

use_from_outside() {
    check_files "$1"
    check_program "$1"
    by_find_package "$1" "$work/$2-find_package"
    by_pkg_config "$1" "$work/$2-pkg_config"
}

rm -rf "$work"
mkdir -p "$work"
"$CMAKE" --install "$build" --prefix "$work/prefix" >"$work/install.log" || { cat "$work/install.log"; fail "cmake --install"; }
use_from_outside "$work/prefix" first
mv "$work/prefix" "$work/moved"
use_from_outside "$work/moved" moved
echo "installed, used, moved and used again"
