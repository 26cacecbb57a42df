# A bare Debian in a folder, as a stranger's machine would be. To be sourced; needs root, debootstrap and unshare.
#   bareWanting                  prints what is missing on this machine for a bare system; false when something is
#   bareNamespace SCRIPT ARGS    runs the script again with mounts and processes of its own, which end with it, whatever happens
#   bareMake SUITE               makes the system in a new folder, whose name is then in $bare_root; bareRemove takes it away
#   bareRun COMMAND ...          runs a command in it as root, with nothing in its environment that this machine brought
#   bareRunAs USER COMMAND ...   the same as an ordinary user
#   bareClone SOURCE FOLDER      puts a fresh clone of the tree into FOLDER of the system, recordings (../shared) beside it
# A new system takes a minute; it is kept as a tarball in ${PERCEPTION_BARE_CACHE:-~/.cache/perception} for the next time.

bareWanting() {
  local missing=()
  (( EUID == 0 )) || missing+=("root")
  local program
  for program in debootstrap unshare tar; do command -v "$program" >/dev/null || missing+=("$program"); done
  (( ${#missing[@]} )) || unshare --mount --pid --fork --propagation private true 2>/dev/null || missing+=("the right to mount")
  (( ${#missing[@]} == 0 )) || { printf '%s\n' "${missing[*]}"; return 1; }
}

bareNamespace() {
  [[ ${PERCEPTION_BARE_INSIDE:-} != 1 ]] || return 0
  exec env PERCEPTION_BARE_INSIDE=1 unshare --mount --pid --fork --kill-child --propagation private "$@"
}

# This machine's Debian mirrors, one "URI SUITE" a line, for the wanted suite.
bareMirrors() {
  local suite=$1 own
  own=$(. /etc/os-release; echo "${VERSION_CODENAME:-bookworm}")
  apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 'Origin: Debian' 'Created-By: Packages' 2>/dev/null |
    sed "s/ $own/ $suite/" | LC_ALL=C sort -u | grep . || echo "http://deb.debian.org/debian $suite"
}

bareAptConfiguration() {
  local suite=$1 root=$2
  rm -f "$root/etc/apt/sources.list"
  bareMirrors "$suite" | sed 's/^/deb /; s/$/ main/' >"$root/etc/apt/sources.list"
  apt-config dump 2>/dev/null | grep -E '^Acquire::(https?|Check-|ForceIPv4|Retries)' >"$root/etc/apt/apt.conf.d/90machine" || true
  echo force-unsafe-io >"$root/etc/dpkg/dpkg.cfg.d/unsafe-io"  # nothing here must survive a power cut
  cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
}

# The tarball is made whole or not at all.
bareTarball() {
  local suite=$1 tarball=$2 folder mirror
  folder=$(mktemp -d "${TMPDIR:-/var/tmp}/perception-debootstrap.XXXXXX")
  mirror=$(bareMirrors "$suite" | awk -v suite="$suite" '$2 == suite { print $1; exit }')
  debootstrap --variant=minbase "$suite" "$folder/bare" "${mirror:-http://deb.debian.org/debian}" >"$folder/log" 2>&1 ||
    { tail -n 20 "$folder/log" >&2; rm -rf "$folder"; echo "debootstrap $suite failed" >&2; return 1; }
  rm -rf "$folder/bare"/var/cache/apt/archives/*.deb
  mkdir -p "$(dirname "$tarball")"
  tar -C "$folder/bare" --one-file-system -cf "$tarball.part" . && mv "$tarball.part" "$tarball"
  rm -rf "$folder"
}

bareMake() {
  local suite=$1 tarball="${PERCEPTION_BARE_CACHE:-${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/perception}/bare-$1.tar"
  [[ -e $tarball ]] || bareTarball "$suite" "$tarball"
  bare_root=$(mktemp -d "${TMPDIR:-/var/tmp}/perception-bare.XXXXXX")
  tar -C "$bare_root" -xf "$tarball"
  chmod 755 "$bare_root"
  bareAptConfiguration "$suite" "$bare_root"
  mount -t proc proc "$bare_root/proc"
  mount -t sysfs -o ro sys "$bare_root/sys"
  mkdir -p "$bare_root/dev/shm" "$bare_root/dev/pts"
  mount -t tmpfs -o mode=1777 shm "$bare_root/dev/shm"
  mount -t devpts -o newinstance,ptmxmode=0666,mode=0620 pts "$bare_root/dev/pts"
}

bareRemove() {
  [[ -n ${bare_root:-} ]] || return 0
  local part
  for part in dev/pts dev/shm sys proc; do umount -l "$bare_root/$part" 2>/dev/null || true; done
  # Nothing of this machine is deleted through a mount that stayed. rm's --one-file-system does not see a folder that is bound there
  # from the same file system.
  if awk -v root="$bare_root/" 'index($5, root) == 1 { found = 1 } END { exit !found }' /proc/self/mountinfo; then
    echo "bare system: something is still mounted below $bare_root, which therefore stays" >&2
    return 1
  fi
  rm -rf --one-file-system "$bare_root"
}

bareRun() {
  chroot "$bare_root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    LC_ALL=C TERM=dumb ${http_proxy:+http_proxy="$http_proxy"} "$@"
}

bareRunAs() {
  local user=$1
  shift
  bareRun setpriv --reuid "$user" --regid "$user" --init-groups env HOME="/srv/$user" USER="$user" "$@"
}

bareClone() {
  local source=$1 target=$bare_root/$2
  mkdir -p "$(dirname "$target")"
  if [[ -e $source/.git ]]; then
    git -c safe.directory='*' -c advice.detachedHead=false clone -q --no-hardlinks "$source" "$target"
    [[ -z $(git -c safe.directory='*' -C "$source" status --porcelain) ]] ||
      echo "bare system: changes that are not committed are not tried" >&2
  else
    mkdir -p "$target"
    tar -C "$source" --exclude='./build*' --exclude=./out -cf - . | tar -C "$target" -xf -
  fi
  [[ ! -d $source/../shared ]] || cp -aH "$source/../shared" "$(dirname "$target")/shared"
}
