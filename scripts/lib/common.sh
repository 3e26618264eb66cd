# Common functions of scripts/ and tools/benchmark, to be sourced. Sets `root`, the folder of the repository.
#
# ROS is built for the system's Python. A pyenv or conda earlier on the PATH lacks its modules, hence this PATH.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)"
if [ ! -d /usr/share/catkin ] && [ -f /opt/ros/noetic/setup.bash ]; then
  . /opt/ros/noetic/setup.bash
fi
set -euo pipefail

fail() {
  echo "${0##*/}: $*" >&2
  exit 1
}

# The apt packages, one list per distribution.
wanted_packages() {
  echo build-essential cmake libeigen3-dev libgtest-dev libopencv-dev libtbb-dev libyaml-cpp-dev nlohmann-json3-dev \
    pkg-config python3-jinja2 python3-matplotlib python3-numpy python3-opencv python3-setuptools python3-tqdm python3-yaml \
    qtbase5-dev
  # Not packaged for Ubuntu 20.04; CMake fetches it there.
  grep -q '^VERSION_CODENAME=focal' /etc/os-release || echo libcli11-dev
  if [ -d /opt/ros/noetic ]; then
    local name
    for name in ackermann-msgs catkin diagnostic-msgs dynamic-reconfigure geometry-msgs nav-msgs nodelet pluginlib \
      rosbag roscpp rosgraph rosgraph-msgs roslaunch rosnode rosout rospy rosservice rostest rostopic rviz sensor-msgs \
      std-msgs std-srvs tf2 tf2-msgs tf2-py tf2-ros visualization-msgs; do
      echo "ros-noetic-$name"
    done
  else
    echo catkin libdynamic-reconfigure-config-init-mutex-dev libnodelet-dev libnodeletlib-dev \
      libnodeletlib-tools pluginlib-dev librosbag-dev librostest-dev librviz-dev libtf2-msgs-dev libtf2-ros-dev \
      python3-diagnostic-msgs python3-dynamic-reconfigure python3-nav-msgs python3-rosbag python3-rosgraph python3-roslaunch python3-rosnode python3-rospy python3-rosservice python3-rostest \
      python3-rostopic python3-sensor-msgs python3-std-srvs python3-tf2 \
      python3-tf2-msgs python3-visualization-msgs ros-core-dev rosbash rosout rviz tf2-tools
  fi
}

# What the checks in checks.sh need, and the tests of optional features. Ubuntu 20.04 has other versions, which find
# other things.
check_packages() {
  if grep -q '^VERSION_CODENAME=bookworm' /etc/os-release; then
    echo catkin-lint clang-format clang-tidy doxygen git pre-commit python3-distributed python3-optuna
  fi
}

# install_packages [PACKAGE...]: installs what is missing of these and of wanted_packages; calls apt only if
# something is.
install_packages() {
  local missing=() package
  for package in $(wanted_packages) "$@"; do
    [ "$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null || true)" = "ii " ] ||
      missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q)
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "neither root nor sudo is available to install the missing" \
      "packages: ${missing[*]}"
    apt=(sudo "${apt[@]}")
  fi
  echo "installing ${#missing[@]} missing packages: ${missing[*]}"
  "${apt[@]}" update
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    fail "apt failed; supported are Debian 12, and Ubuntu 20.04 with ROS Noetic"
}

# The number of cores, limited to one job per 1.5 GB of available memory.
build_jobs() {
  local cores memory
  cores=$(nproc)
  memory=$(awk '/^MemAvailable/ { print int($2 / 1500000) }' /proc/meminfo)
  echo $((memory < 1 ? 1 : memory < cores ? memory : cores))
}

# configure_in FOLDER [cmake arguments]: configures if new or if arguments are given.
configure_in() {
  local folder="$root/$1"
  shift
  if [ ! -f "$folder/Makefile" ] || [ $# -gt 0 ]; then
    mkdir -p "$folder"
    cmake -S "$root" -B "$folder" -DPYTHON_EXECUTABLE=/usr/bin/python3 "$@" \
      >"$folder/configure.log" 2>&1 || {
      cat "$folder/configure.log" >&2
      return 1
    }
  fi
}

# build_in FOLDER TARGET [cmake arguments]: configures as configure_in does, then builds.
build_in() {
  local folder="$1" target="$2"
  shift 2
  configure_in "$folder" "$@" || return 1
  cmake --build "$root/$folder" --target "$target" -j "$(build_jobs)"
}
