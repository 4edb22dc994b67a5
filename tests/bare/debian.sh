# A minimal Debian in a folder, for tests that nothing of this machine may help: sourced by tests/bare/run.sh and those of
# tests/packages. Wants root, mmdebstrap and the package registry.
cache=${XDG_CACHE_HOME:-$HOME/.cache}/plenoflame/bare

# bare_debian [RELEASE]: makes $cache/debian, a Debian 12, unless it is there; of another release, such as trixie, $cache/RELEASE.
bare_debian() {
  local release=${1:-bookworm} system=${1:-debian} made each sources=()
  [ ! -d "$cache/$system" ] || return 0
  mkdir -p "$cache/archives"
  made=$(mktemp -d "$cache/made.XXXXXX")  # another run may make one, too
  chmod 755 "$made"
  mmdebstrap --quiet --variant=minbase --include=ca-certificates "$release" "$made"
  [ "$system" != debian ] || { rm -f "$made/etc/apt/sources.list" && sources=(/etc/apt/sources.list /etc/apt/sources.list.d); }
  echo force-unsafe-io >"$made/etc/dpkg/dpkg.cfg.d/quick"
  # The new system reaches the registry in the way that this one does.
  for each in "${sources[@]}" /etc/apt/apt.conf.d /etc/apt/auth.conf.d /etc/ssl/certs/ca-certificates.crt /etc/resolv.conf; do
    [ ! -e "$each" ] || { mkdir -p "$made$(dirname "$each")" && cp -aL --remove-destination "$each" "$made$(dirname "$each")/"; }
  done
  rm -f "$made/etc/apt/apt.conf.d/"*clean*  # packages are kept for the next system
  mv -T "$made" "$cache/$system" 2>/dev/null || rm -rf --one-file-system "$made"
}

# has_overlays: false in a container whose own files are an overlay, on which there is no other one.
has_overlays() {
  local probe status=0
  mkdir -p "$cache"
  probe=$(mktemp -d "$cache/probe.XXXXXX")
  mkdir "$probe"/{lower,upper,work,system}
  mount -t overlay overlay -o "lowerdir=$probe/lower,upperdir=$probe/upper,workdir=$probe/work" "$probe/system" 2>/dev/null || status=1
  [ "$status" -ne 0 ] || umount "$probe/system"
  rm -rf --one-file-system "$probe"
  return "$status"
}

# open_debian ROOT LAYER...: ROOT/system shows the layers, the last one on top, and keeps what is written in ROOT/written.
open_debian() {
  local root=$1 lower= each
  shift
  for each in "$@"; do lower=$each${lower:+:$lower}; done
  mkdir -p "$root/system" "$root/written" "$root/work"
  mount -t overlay overlay -o "lowerdir=$lower,upperdir=$root/written,workdir=$root/work" "$root/system"
  mount -t proc proc "$root/system/proc"
  mount --bind /sys "$root/system/sys"  # MPI asks it for the processors
  mount --bind /dev "$root/system/dev"
  mount --bind /dev/pts "$root/system/dev/pts"
  mkdir -p "$root/system/dev/shm" "$root/system/var/cache/apt/archives"
  # apt locks its folder of packages: several runs have links to the same ones.
  cp -al "$cache/archives" "$root" && rm -f "$root/archives/lock"
  mount --bind "$root/archives" "$root/system/var/cache/apt/archives"
}

close_debian() {  # ROOT
  local each
  find "$1/archives" -maxdepth 1 -name '*.deb' -exec cp -aln -t "$cache/archives" {} + 2>/dev/null || true
  for each in srv/ccache var/cache/apt/archives dev/pts dev sys proc .; do
    if mountpoint -q "$1/system/$each"; then umount --lazy "$1/system/$each"; fi
  done
  rm -rf --one-file-system "$1/archives"
}

# in_debian ROOT COMMAND...: with nothing of this machine's environment but the way to the registry.
in_debian() {
  local root=$1
  shift
  env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LANG=C HOME=/root \
    ${http_proxy:+http_proxy="$http_proxy"} ${https_proxy:+https_proxy="$https_proxy"} chroot "$root/system" "$@"
}
