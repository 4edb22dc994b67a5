#!/bin/bash
# Installs the packages of FOLDER into a fresh minimal Debian 12 and uses them there as somebody would who has never
# seen the project: renders, scripts, opens the desktop application, builds a C++ program. Wants root, mmdebstrap and
# the package registry.
#
#   tests/packages/run.sh FOLDER [PICTURES]
#
# PICTURES receives what was drawn there: the window of the desktop application, a scene, ParaView's.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -eq 1 ] || [ $# -eq 2 ] || { sed -n '6s/^# *//p' "$0" >&2; exit 2; }
packages=$(cd "$1" && pwd)
ls "$packages"/plenoflame_*.deb >/dev/null

root=$(mktemp -d)
unmount() {
  for each in dev/shm dev proc; do
    if mountpoint -q "$root/$each"; then umount --lazy "$root/$each"; fi
  done
  rm -rf --one-file-system "$root"
}
trap unmount EXIT
mmdebstrap --quiet --variant=minbase --include=ca-certificates bookworm "$root"
rm -f "$root/etc/apt/sources.list"
# The new system reaches the registry in the way that this one does.
for each in /etc/apt/sources.list /etc/apt/sources.list.d /etc/apt/apt.conf.d /etc/apt/auth.conf.d \
  /etc/ssl/certs/ca-certificates.crt /etc/resolv.conf; do
  [ ! -e "$each" ] || { mkdir -p "$root$(dirname "$each")" && cp -aL --remove-destination "$each" "$root$(dirname "$each")/"; }
done
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
mkdir -p "$root/packages" "$root/dev/shm"
cp "$packages"/*.deb "$root/packages"
cp "$here/first_use.sh" "$here/../install/consumer/core.cpp" "$root/packages"
mkdir -p "$root/packages/tree/tools" "$root/packages/tree/docs/user"
cp "$here/../../tools/measure_tutorial.py" "$root/packages/tree/tools"
cp "$here/../../docs/user/tutorial.md" "$root/packages/tree/docs/user"
env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C HOME=/nonexistent \
  ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} \
  chroot "$root" bash /packages/first_use.sh
[ $# -lt 2 ] || { mkdir -p "$2" && cp "$root"/first/windows/*.png "$root"/first/*.png "$2"; }
