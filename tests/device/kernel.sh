#!/usr/bin/env bash
# Runs a test program under a kernel of its own, in QEMU without acceleration: the real usbfs, hidraw, USB/IP and uhid of a
# Debian kernel, and nothing of this machine's. All is in an initramfs that is made here; no disk, no network, no rights.
#
# usage: kernel.sh PROGRAM KERNEL WORK [FILE...]
#   PROGRAM   and the shared libraries that it needs or loads are copied into the initramfs
#   KERNEL    a folder into which the kernel's package was unpacked (scripts/test --full does)
#   WORK      is made anew
#   FILE      is there under its whole name, too
# Needs qemu-system-x86_64 and a static busybox. Exit status 77 if something is not there, 1 with FRM_KERNEL_REQUIRE=1.
set -euo pipefail

program=$(realpath "$1")
kernel=$2
work=$3
shift 3
modules=(usb-common usbcore usbip-core vhci-hcd hid hid-generic uhid)  # in the order in which they need each other
loaded=(libusb-1.0.so.0 libhidapi-hidraw.so.0)                         # by dlopen

missing() {
    [ "${FRM_KERNEL_REQUIRE:-0}" = 1 ] || { echo "skipped: $* (scripts/test --full gets it)"; exit 77; }
    echo "wrong: $*" >&2
    exit 1
}

for tool in qemu-system-x86_64 busybox; do
    command -v "$tool" >/dev/null || missing "$tool is not installed"
done
image=$(find "$kernel/boot" -name 'vmlinuz-*' 2>/dev/null | sort | tail -n 1)
[ -n "$image" ] || missing "there is no kernel in $kernel"
version=${image##*/vmlinuz-}

rm -rf "$work"
root=$work/root
mkdir -p "$root"/{bin,dev,proc,sys,tmp,modules}
cp "$(command -v busybox)" "$root/bin/busybox"
cp "$program" "$root/bin/program"

# Module FILE of the kernel, whichever way it is packed; one that is built in has none.
for module in "${modules[@]}"; do
    found=$(find "$kernel/lib/modules/$version" -name "$module.ko*" | head -n 1)
    case $found in
    *.ko) cp "$found" "$root/modules/$module.ko" ;;
    *.ko.xz) xz -dc "$found" >"$root/modules/$module.ko" ;;
    *.ko.zst) zstd -qdc "$found" >"$root/modules/$module.ko" ;;
    *)
        grep -q "/$module.ko$" "$kernel/lib/modules/$version/modules.builtin" ||
            missing "kernel $version has no module $module"
        ;;
    esac
done

# Libraries lie where this machine has them; of those that are loaded ldconfig knows the place.
libraries=()
for name in "${loaded[@]}"; do
    path=$(PATH=$PATH:/usr/sbin:/sbin ldconfig -p | awk -v name="$name" '$1 == name && /x86-64/ { print $NF; exit }')
    [ -n "$path" ] || missing "$name is not installed"
    libraries+=("$path")
done
for file in "$program" "${libraries[@]}"; do
    while read -r path; do
        mkdir -p "$root$(dirname "$path")"
        cp -L "$path" "$root$path"
    done < <({ ldd "$file" | grep -o '/[^ ]*'; [ "$file" = "$program" ] || echo "$file"; } | sort -u)
done

for file in "$@"; do
    mkdir -p "$root$(dirname "$file")"
    cp "$file" "$root$file"
done

# What the kernel starts. The program's exit status is the last line that it prints.
cat >"$root/init" <<END
#!/bin/busybox sh
/bin/busybox mount -t devtmpfs none /dev
/bin/busybox mount -t proc none /proc
/bin/busybox mount -t sysfs none /sys
/bin/busybox mount -t tmpfs none /tmp
for module in ${modules[*]}; do
    [ ! -e /modules/\$module.ko ] || /bin/busybox insmod /modules/\$module.ko || echo "wrong: \$module"
done
cd /tmp
/bin/program
echo "exit status \$?"
/bin/busybox poweroff -f
END
chmod +x "$root/init"
(cd "$root" && find . | busybox cpio -o -H newc 2>/dev/null | gzip -1) >"$work/initramfs.gz"

# -cpu max: what the emulator has, vectors too. One processor: two took 2.5 times as long on a busy machine. A panic ends the
# machine (-no-reboot). The time is for a starved one.
timeout --foreground 1500 qemu-system-x86_64 -accel tcg -cpu max -smp 1 -m 512 -nodefaults -display none -no-reboot \
    -kernel "$image" -initrd "$work/initramfs.gz" -append "console=ttyS0 quiet panic=-1" -serial "file:$work/console" \
    </dev/null || echo "QEMU ended with status $?"
tr -d '\r' <"$work/console"
tr -d '\r' <"$work/console" | grep -qx 'exit status 0'
