# Sourced in the private namespace: the unpacked packages over /usr, a folder for the test, and what tests share.
set -euo pipefail
root=$1 castray=$2 scene=$3
mount -t overlay overlay -o "lowerdir=$root/usr:/usr" /usr
work=$(mktemp -d)
trap 'status=$?; cd /; [ $status -eq 0 ] || tail -n 20 "$work"/*.log "$work"/*/*.log >&2 || true; rm -rf "$work"; exit $status' EXIT
cd "$work"

# wait_for SECONDS WHAT COMMAND...: until the command succeeds.
wait_for() {
  local seconds=$1 what=$2
  shift 2
  for ((i = 0; i < 5 * seconds; ++i)); do
    if "$@" >>wait.log 2>&1; then return; fi
    sleep 0.2
  done
  echo "no $what within $seconds s" >&2
  return 1
}

# The render that all parts together must equal.
flags=(--size 96x96 --spp 4000 --seed 7)
render_whole() { "$castray" render "$scene" "${flags[@]}" -q -o whole.film -o whole.pfm; }

same_as_whole() {
  cmp whole.film merged.film
  cmp whole.pfm merged.pfm
}
