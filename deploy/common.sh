# Sourced by the scripts that build: where the project is and which version, usage and a last word, how many compilers fit, and a
# step clock.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
script=$(realpath "$0")

die() {
  echo "$(basename "$0" .sh): $*" >&2
  exit 1
}

# usage WORD: the comment that the script begins with; 0 where it was asked for by --help, else 2.
usage() {
  awk 'NR == 1 {next} !/^#/ {exit} {sub(/^# ?/, ""); print}' "$script"
  [ "$1" = --help ] || [ "$1" = -h ] || exit 2
  exit 0
}

# As CMakeLists.txt has it, without a commit.
project_version() { sed -n 's/^project(obliq VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt"; }

# Exports SOURCE_DATE_EPOCH, the time of the sources, where it is not set: packages of the same sources are equal.
set_source_date() {
  export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 1577836800)}
}

# One compiler a core, but no more than memory holds (the largest files take about 1.2 GB).
parallel_jobs() {
  local cores memory_kb jobs
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo 2>/dev/null || true)
  jobs=$((${memory_kb:-4000000} / 1200000))
  [ "$jobs" -ge 1 ] || jobs=1
  [ "$jobs" -le "$cores" ] || jobs=$cores
  echo "$jobs"
}

# The first Python that has some modules: python_with MODULE,.... Where another one stands first in the PATH, it is Debian's own.
python_with() {
  local python
  for python in python3 /usr/bin/python3; do
    if "$python" -c "import $1" 2>/dev/null; then
      echo "$python"
      return
    fi
  done
  echo "no python3 here with $1" >&2
  return 1
}

# debian_sources DIR PACKAGE...: Debian's source packages into DIR/src, from the archive that this machine's apt is set up with and
# without a change to its lists. OR_OF_RELEASE=1: the release's own version where the archive has the newest no more.
debian_sources() {
  local work=$1 apt=$1/apt
  shift
  mkdir -p "$work/src" "$apt"/{lists/partial,cache/archives/partial}
  apt-get indextargets --format '$(CREATED_BY)|$(ORIGIN)|$(REPO_URI)|$(RELEASE)' |
    awk -F '|' '$1 == "Packages" && $2 == "Debian" && !seen[$3 $4]++ {print "deb-src", $3, $4, "main"}' >"$apt/sources.list"
  [ -s "$apt/sources.list" ] || die "apt knows no Debian archive here (apt-get update?)"
  local options=(-q -o Dir::Etc::SourceList="$apt/sources.list" -o Dir::Etc::SourceParts=/dev/null
    -o Dir::State::Lists="$apt/lists" -o Dir::Cache="$apt/cache" -o APT::Sandbox::User=root)
  apt-get "${options[@]}" update && (cd "$work/src" && {
    apt-get "${options[@]}" source "$@" || { [ -n "${OR_OF_RELEASE-}" ] &&
      apt-get "${options[@]}" source "${@/%//$(. /etc/os-release && echo "$VERSION_CODENAME")}"; }
  })
}

step_name=""
step_began=0
step_end() {
  [ -z "$step_name" ] || echo "== $step_name: $((SECONDS - step_began)) s"
  step_name=""
}
step() {
  step_end
  step_name=$1
  step_began=$SECONDS
  echo
  echo "== $step_name"
}
