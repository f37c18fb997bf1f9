#!/bin/sh
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
#
# Both sites in network namespaces of their own, with a cable between them that is pulled:
#   two_sites_cable.sh PCAVR FOLDER
# Needs no privileges where user namespaces are permitted; else exits with 77 (skipped). Where the
# kernel has netem, the cable delays by 20 +- 5 ms and loses 2 %.
set -eu
if [ "${3:-}" != inside ]; then
  command -v ip > /dev/null && unshare -rn true 2> /dev/null || exit 77
  exec unshare -rn sh "$0" "$1" "$2" inside
fi
pcavr=$1
rm -rf "$2" && mkdir -p "$2" && cd "$2"

fail() {
  echo "FAILED: $1"
  cat robot.err operator.err
  exit 1
}

# until_said FILE TEXT OTHERWISE: waits for a line of a site.
until_said() {
  for _ in $(seq 300); do
    if grep -q "$2" "$1"; then return; fi
    sleep 0.1
  done
  fail "$3"
}

"$pcavr" simulate push --no-images --seed 3 -o recording > /dev/null
"$pcavr" build recording -o scene > /dev/null
"$pcavr" keygen robot -o keys > /dev/null
"$pcavr" keygen alice -o keys > /dev/null
mkdir authorized && cp keys/alice.pub authorized/

unshare -n sleep 100 &
operator=$!
trap 'kill $operator $(jobs -p) 2> /dev/null || true' EXIT
until [ "$(readlink /proc/$operator/ns/net)" != "$(readlink /proc/self/ns/net)" ]; do sleep 0.1; done
at_operator() { nsenter -t $operator -n "$@"; }
ip link set lo up
ip link add robot type veth peer name operator
ip link set operator netns $operator
ip address add 10.77.0.1/24 dev robot
ip link set robot up
at_operator ip address add 10.77.0.2/24 dev operator
at_operator ip link set operator up
tc qdisc add dev robot root netem delay 20ms 5ms loss 2% 2> /dev/null || echo "no netem: without delay"

"$pcavr" robot-site scene --recording recording --host 10.77.0.1 --port 5670 --key keys/robot.key \
  --authorized authorized --json > robot.json 2> robot.err &
robot=$!
until [ -s robot.json ]; do
  kill -0 $robot 2> /dev/null || fail "the robot's site has ended"
  sleep 0.1
done
at_operator "$pcavr" operator-site scene --trace recording --host 10.77.0.1 --port 5670 \
  --key keys/alice.key --robot-key keys/robot.pub --json > operator.json 2> operator.err &
site=$!
until_said robot.err "operator's site connected" "no session"
sleep 2
ip link set robot down
until_said robot.err "nothing from the operator's site" "the robot's site does not hold"
until_said operator.err "nothing from the robot's site" "the operator's clutch is not open"
sleep 1
ip link set robot up
wait $site || fail "operator-site"
wait $robot || fail "robot-site"
grep -q "connected again" operator.err || fail "no new session"
grep -q '"invalid_messages": *0' operator.json || fail "invalid messages"
