#!/bin/bash
# try_package.sh ROOT PACKAGE: makes a bare Debian 12 in the empty folder ROOT, installs PACKAGE there and runs the
# simulated car. scripts/package starts it in mount and PID namespaces of its own; the mounts end with them.
set -euo pipefail
bare_root="$1"
package="$2"
log="$(dirname "$package")/try.log"

result_failed() {
  tail -n 30 "$log" >&2
  echo "failed: $*"
  exit 1
}

# Runs a command in the root without the environment of the caller, which may contain that of a catkin workspace.
in_root() {
  env -i PATH="$PATH" HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive http_proxy="${http_proxy:-}" \
    chroot "$bare_root" "$@"
}

make_root() {
  debootstrap --variant=minbase bookworm "$bare_root" &&
    echo "127.0.0.1 localhost" >"$bare_root/etc/hosts" &&
    cp -L /etc/resolv.conf "$bare_root/etc/resolv.conf" &&
    mount -t proc proc "$bare_root/proc" &&
    mkdir -p "$bare_root/dev/pts" &&
    mount -t devpts devpts "$bare_root/dev/pts" &&
    # No service starts in the chroot.
    printf '#!/bin/sh\nexit 101\n' >"$bare_root/usr/sbin/policy-rc.d" &&
    chmod +x "$bare_root/usr/sbin/policy-rc.d"
}

# Without recommended packages: the dependencies alone must be enough.
install_package() {
  cp "$package" "$(dirname "${BASH_SOURCE[0]}")/localized_car.py" "$bare_root/tmp/" &&
    in_root apt-get -q update &&
    in_root apt-get -q install -y --no-install-recommends "/tmp/$(basename "$package")"
}

# Compilers in the root, one per line.
compilers() {
  in_root dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' |
    sed -nE 's/^ii +((gcc|g\+\+|cpp|clang|tcc)(-[0-9.]+)?|build-essential)$/\1/p'
  in_root sh -c 'for name in cc c++ gcc g++ clang cpp; do command -v $name; done; true'
}

make_root >"$log" 2>&1 || result_failed "debootstrap or mount: $log"
install_package >>"$log" 2>&1 || result_failed "the installation of the package: $log"
unwanted=$(compilers)
[ -z "$unwanted" ] || result_failed "the package depends on a compiler: "$unwanted
# Debian's python3-nav-msgs depends on header packages, which nothing may need at run time.
rm -rf "$bare_root/usr/include"
in_root sh -c 'cd / && rosrun racecar_mcl map_check --help' >>"$log" 2>&1 || result_failed "rosrun: $log"
in_root python3 /tmp/localized_car.py
