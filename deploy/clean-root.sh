# Sourced by build-image.sh and check-packages.sh: Debian's minimal system in a folder, from the archive that this machine's apt is
# set up with.

# archive LABEL: where this machine's apt finds Debian (LABEL Debian) or its security updates (Debian-Security).
archive() {
  apt-get indextargets --format '$(CREATED_BY)|$(ORIGIN)|$(LABEL)|$(REPO_URI)' |
    awk -F '|' -v label="$1" '$1 == "Packages" && $2 == "Debian" && $3 == label && !seen++ {print $4}'
}

# clean_root SUITE FOLDER: with its apt set up, in minutes; FOLDER.log says what happened.
clean_root() {
  local suite=$1 folder=$2 main security extra=()
  main=$(archive Debian)
  security=$(archive Debian-Security)
  [ -n "$main" ] || die "apt knows no Debian archive here (apt-get update?)"
  rm -rf --one-file-system "$folder"
  case "$main" in https:*) extra=(--include=ca-certificates) ;; esac
  # In a mount namespace of its own, so that what it mounts goes when it ends.
  unshare --mount debootstrap --variant=minbase "${extra[@]}" --keyring=/usr/share/keyrings/debian-archive-keyring.gpg \
    "$suite" "$folder" "$main" >"$folder.log" 2>&1 ||
    die "debootstrap failed; see $folder.log"
  {
    echo "deb $main $suite main"
    echo "deb $main $suite-updates main"
    [ -z "$security" ] || echo "deb $security $suite-security main"
  } >"$folder/etc/apt/sources.list"
  echo force-unsafe-io >"$folder/etc/dpkg/dpkg.cfg.d/unsafe-io" # one that breaks off is not kept anyway
}
