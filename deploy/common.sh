# Sourced by the scripts that build: where the project is, a last word, how many compilers fit, and a step clock.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

die() {
  echo "$(basename "$0" .sh): $*" >&2
  exit 1
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
