# Sourced by the checks: lists the project's own files of the given kinds, build output left out.
#   source_files h cpp       prints one path a line, relative to the project root
source_files() {
  local kind names=()
  for kind in "$@"; do names+=(-o -name "*.$kind"); done
  find . \( -path ./build -o -path ./out -o -path ./.git \) -prune -o -type f \( "${names[@]:1}" \) -print |
    sort
}
