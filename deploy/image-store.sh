# Sourced by build-image.sh and check-image.sh: the folder that images are kept in, and buildah told of it.
. "$(dirname "${BASH_SOURCE[0]}")/common.sh"

store=${OBLIQ_IMAGES:-${TMPDIR:-/var/tmp}/obliq-images}

as_root() {
  [ "$(id -u)" -eq 0 ] || die "run it as root: it makes a system in a folder and runs programs in it"
}

need() {
  local program
  for program in "$@"; do
    command -v "$program" >/dev/null || die "'$program' is not installed"
  done
}

# vfs needs nothing of the kernel; the policy is for images that are all made here.
buildah_() {
  if [ ! -f "$store/policy.json" ]; then
    mkdir -p "$store"
    echo '{"default": [{"type": "insecureAcceptAnything"}]}' >"$store/policy.json"
  fi
  local policy=()
  case "$1" in
    bud | commit | from) policy=(--signature-policy "$store/policy.json") ;;
  esac
  buildah --storage-driver vfs --root "$store/root" --runroot "$store/run" "$1" "${policy[@]}" "${@:2}"
}

image_name() {
  echo "localhost/obliq:$1"
}

has_image() {
  buildah_ images -q "$1" >/dev/null 2>&1
}

remove_store() {
  if findmnt -rno TARGET | grep -q "^$store/"; then
    die "something is still mounted in $store"
  fi
  rm -rf --one-file-system "$store"
}
