# Building and trying the Debian package; source it after common.sh.

package_folder="$root/build/package"

# Copies the source tree without what was built in it, builds the copy and keeps the package and build.log in
# $package_folder. The copy is outside of the clone, where roslaunch would find every launch file twice.
build_package() {
  temporary_folder=$(mktemp -d)
  trap remove_temporary_folder EXIT
  local source="$temporary_folder/source"
  rm -rf "$package_folder"
  mkdir -p "$source" "$package_folder"
  tar -C "$root" --exclude=./build --exclude='./build-*' --exclude=./.devel --exclude=./.git --exclude=__pycache__ \
    -cf - . | tar -C "$source" -xf -
  (
    cd "$source"
    DEB_BUILD_OPTIONS="noautodbgsym parallel=$(build_jobs)" dpkg-buildpackage --build=binary --no-sign
  ) >"$package_folder/build.log" 2>&1 || {
    tail -n 30 "$package_folder/build.log" >&2
    fail "the build failed; the whole log: $package_folder/build.log"
  }
  mv "$temporary_folder"/racecar-mcl_* "$package_folder"
  remove_temporary_folder
}

# The file of the built package.
package_file() {
  ls "$package_folder"/racecar-mcl_*.deb
}

# The paths that the package installs, one per line.
package_paths() {
  dpkg-deb --fsys-tarfile "$(package_file)" | tar -t | sed 's/^\.//'
}

# Programs, libraries, data and Python modules are where Debian's ROS finds them. Files of a catkin workspace, which
# would make one of /usr, are absent.
check_package_paths() {
  local paths path
  paths=$(package_paths)
  for path in /usr/lib/racecar_mcl/localization_node /usr/share/racecar_mcl/launch/localize.launch \
    "/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)/libracecar_mcl_localization_nodelet.so" \
    "/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)/libracecar_mcl_rviz_panel.so" \
    /usr/lib/python3/dist-packages/racecar_mcl_eval/html_report.html.j2; do
    grep -qx "$path" <<<"$paths" || fail "the package lacks $path"
  done
  if grep -E '/(\.catkin|\.rosinstall|env\.sh|_setup_util\.py|(local_)?setup\.(ba|z)?sh)$|^/usr/local' <<<"$paths"; then
    fail "these paths do not belong into the package"
  fi
}

# try_package [FOLDER]: runs the package in a bare Debian 12 below FOLDER, by default that of temporary files. The
# mounts and processes are in namespaces of their own, which end with this script.
try_package() {
  [ "$(id -u)" -eq 0 ] || fail "--try needs root (debootstrap, chroot)"
  temporary_folder=$(mktemp -d "${1:-${TMPDIR:-/tmp}}/racecar_mcl.XXXXXX")
  trap remove_temporary_folder EXIT
  set -m  # without job control, a background process ignores SIGINT, by which roslaunch ends its nodes
  unshare --mount --pid --fork --kill-child --mount-proc \
    bash "$root/scripts/lib/try_package.sh" "$temporary_folder" "$(package_file)" </dev/null &
  namespace_process=$!
  local status=0
  wait "$namespace_process" || status=$?
  namespace_process=
  return $status
}

# unshare blocks SIGINT and SIGTERM. Its end kills everything in its PID namespace, and so unmounts.
remove_temporary_folder() {
  if kill -KILL "${namespace_process:-}" 2>/dev/null; then wait "$namespace_process" 2>/dev/null || true; fi
  rm -rf --one-file-system "$temporary_folder"
}
