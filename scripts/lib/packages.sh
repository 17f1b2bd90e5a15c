# shellcheck shell=bash
# Installs what is missing from Debian or Ubuntu packages. Source it after stages.sh.

# shellcheck disable=SC2034  # these are used by the scripts that source this file
packages_build=(g++ cmake ninja-build pkg-config libzstd-dev libtinygltf-dev libkissfft-dev libcli11-dev
    nlohmann-json3-dev python3 python3-matplotlib python3-numpy)
# shellcheck disable=SC2034
packages_test=(catch2 python3-pytest)
# Not in every release; what needs one is left out without it (libmujoco-dev: a peer in `frm bench`; libusb and hidapi: the
# SPIDAR-G driver; umockdev: a USB bus for its tests).
# shellcheck disable=SC2034
packages_optional=(libmujoco-dev libusb-1.0-0-dev libhidapi-dev umockdev libumockdev-dev)
# shellcheck disable=SC2034
packages_full=(slurm-wlm munge openmpi-bin clang libomp-dev qemu-user-static g++-aarch64-linux-gnu
    g++-mingw-w64-x86-64-posix wine wine64 emscripten nodejs qemu-system-x86 busybox-static)

# Always the system's Python: the packages above belong to it, and a version manager's python3 in PATH has none of them.
# shellcheck disable=SC2034
python=/usr/bin/python3

package_installed() {
    # A package that another one provides (pkgconf for pkg-config, on newer systems) has no entry of its own.
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ] ||
        dpkg-query -W -f '${db:Status-Status} ${Provides}\n' | grep '^installed' | tr -s ' ,' '\n' | grep -Fx -- "$1" >/dev/null
}

# Runs a command as root, by sudo where needed. Without a terminal sudo must not wait for a password.
as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif [ -t 0 ]; then
        sudo "$@"
    else
        sudo -n "$@"
    fi
}

# Mirrors fail at times: three tries, with a growing pause.
apt_retry() {
    local try
    for try in 1 2 3; do
        if as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 \
            -o Dpkg::Use-Pty=0 "$@"; then
            return 0
        fi
        [ "$try" -eq 3 ] || { say "apt-get $1 failed, trying again"; sleep $((try * 5)); }
    done
    return 1
}

# The tools without which no build can start, for systems whose packages have other names.
tools_missing() {
    local tool
    for tool in c++ cmake ninja pkg-config "$python"; do
        command -v "$tool" >/dev/null || printf '%s ' "$tool"
    done
}

install_packages() {
    local package missing=()
    if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
        say "this is not a Debian or Ubuntu system; what these packages hold must be there: $*"
        local tools
        tools=$(tools_missing)
        [ -z "$tools" ] || die "not found: $tools"
        say "the tools are there; going on (a library that is missing shows when CMake runs)"
        return 0
    fi
    for package in "$@"; do
        package_installed "$package" || missing+=("$package")
    done
    if [ "${#missing[@]}" -eq 0 ]; then
        say "all packages are there"
        return 0
    fi
    if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null; then
        die "not root and no sudo here; please install: ${missing[*]}"
    fi
    say "installing: ${missing[*]}"
    apt_retry update || die "apt-get update failed"
    apt_retry install -y --no-install-recommends "${missing[@]}" || die "apt-get install failed for: ${missing[*]}"
}

# unpack_kernel FOLDER: Debian's kernel for a virtual machine (tests/device/kernel.sh). It is unpacked, not installed: this
# machine goes on with its own. Only what lies in boot/ and the modules of USB and HID are kept. linux-image-cloud-amd64 is
# smaller, but has no USB.
unpack_kernel() {
    local folder=$1 package
    command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || return 0
    package=$(apt-cache depends linux-image-amd64 2>/dev/null | awk '$1 == "Depends:" && $2 ~ /^linux-image-[0-9]/ { print $2 }')
    if [ -z "$package" ]; then
        say "going on without a kernel for the virtual machine: apt has no linux-image-amd64"
        return 0
    fi
    [ ! -e "$folder/$package" ] || return 0
    say "unpacking $package in $folder"
    rm -rf "$folder"
    mkdir -p "$folder/package"
    (cd "$folder/package" && { apt-get -q download "$package" || { apt_retry update && apt-get -q download "$package"; }; }) ||
        die "apt-get download failed for: $package"
    dpkg-deb --fsys-tarfile "$folder"/package/*.deb | tar -x -C "$folder" --wildcards './boot/vmlinuz-*' \
        './lib/modules/*/modules.builtin' './lib/modules/*/kernel/drivers/usb/*' './lib/modules/*/kernel/drivers/hid/*'
    rm -r "$folder/package"
    touch "$folder/$package"
}

# What can be had of these; nothing ends if that is none.
install_optional_packages() {
    local package
    command -v apt-get >/dev/null && command -v dpkg-query >/dev/null || return 0
    for package in "$@"; do
        package_installed "$package" && continue
        apt-cache show "$package" >/dev/null 2>&1 || apt_retry update || true
        say "installing, if it can be had: $package"
        apt-cache show "$package" >/dev/null 2>&1 && apt_retry install -y --no-install-recommends "$package" ||
            say "going on without $package"
    done
}
