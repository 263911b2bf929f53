#!/usr/bin/env bash
# Builds the image of deploy/Dockerfile where there is no container engine and no image registry: the base image
# is made from the Debian archive that this machine's apt is set up with.
#
#   deploy/build-image.sh [bookworm|trixie]      default: bookworm
#
# Needs root; installs buildah and debootstrap on this machine where they are missing, with what apt brings along for them. Takes
# some ten minutes and 9 GB, and says which step it is at. The images stay in
# $OBLIQ_IMAGES (default: obliq-images in $TMPDIR or /var/tmp), which deploy/check-image.sh reads and
# `deploy/build-image.sh clean` removes. OBLIQ_JOBS: compilers at a time. OBLIQ_TARGET: a stage to stop after.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/image-store.sh"
. "$(dirname "${BASH_SOURCE[0]}")/clean-root.sh"
cd "$root"

suite=bookworm
case "${1-}" in
  "") ;;
  bookworm | trixie) suite=$1 ;;
  clean)
    remove_store
    exit 0
    ;;
  -h | --help) usage "$1" ;;
  *) die "unknown suite '$1'; allowed: bookworm, trixie, clean" ;;
esac
as_root
"$root"/deploy/install-deps.sh image
need buildah debootstrap unshare apt-get

# The base image that Dockerfiles know as debian:SUITE-slim: Debian's minimal system without manuals.
make_base() {
  local folder=$store/base-$suite working
  rm -f "$folder.tar"
  clean_root "$suite" "$folder"
  printf 'path-exclude %s\n' '/usr/share/doc/*' '/usr/share/man/*' '/usr/share/info/*' '/usr/share/locale/*' \
    '/usr/share/groff/*' '/usr/share/lintian/*' >"$folder/etc/dpkg/dpkg.cfg.d/slim"
  echo 'path-include /usr/share/doc/*/copyright' >>"$folder/etc/dpkg/dpkg.cfg.d/slim"
  printf 'Acquire::Languages "none";\nAcquire::GzipIndexes "true";\n' >"$folder/etc/apt/apt.conf.d/slim"
  find "$folder"/usr/share/doc -mindepth 2 ! -type d ! -name copyright -delete
  rm -rf --one-file-system "$folder"/usr/share/{man,info,locale,groff,lintian}/* "$folder"/var/lib/apt/lists/* \
    "$folder"/var/cache/apt/* "$folder"/var/log/*.log "$folder"/dev/* "$folder"/proc/* "$folder"/sys/*
  tar -C "$folder" --one-file-system -cf "$folder.tar" .
  working=$(buildah_ from scratch)
  buildah_ add -q "$working" "$folder.tar" / >/dev/null
  buildah_ config --cmd /bin/bash "$working"
  buildah_ commit -q --rm --format docker "$working" "docker.io/library/debian:$suite-slim" >/dev/null
  rm -rf --one-file-system "$folder" "$folder.tar"
}

mkdir -p "$store"
if has_image "docker.io/library/debian:$suite-slim"; then
  echo "base image debian:$suite-slim: there already"
else
  step "base image debian:$suite-slim"
  make_base
fi

step "image $(image_name "$suite")"
build_log=$store/build-$suite.log
if ! buildah_ bud --isolation chroot --pull-never --format docker --layers -f deploy/Dockerfile \
  --ignorefile .dockerignore --build-arg "DEBIAN=$suite" --build-arg "JOBS=${OBLIQ_JOBS:-$(parallel_jobs)}" \
  --build-arg "VERSION=$(project_version)" \
  --build-arg "REVISION=$(git describe --always --dirty --abbrev=7 --exclude='*' 2>/dev/null || echo unknown)" \
  --build-arg "CREATED=$(date -u +%Y-%m-%dT%H:%M:%SZ)" \
  ${OBLIQ_TARGET:+--target "$OBLIQ_TARGET"} -t "$(image_name "$suite")${OBLIQ_TARGET:+-$OBLIQ_TARGET}" . 2>&1 |
  tee "$build_log" | sed -un -E 's/^((\[[0-9/]+\] )?STEP [0-9/]+: .{0,120}).*/\1/p; s/^\[([0-9]+)00\/([0-9]+)\] .*/    \100 of \2 compiled and linked/p'; then
  tail -n 60 "$build_log" >&2
  die "the build failed; all of it is in $build_log"
fi
step_end
buildah_ images --format '{{.Name}}:{{.Tag}} {{.Size}}' "$(image_name "$suite")${OBLIQ_TARGET:+-$OBLIQ_TARGET}"
