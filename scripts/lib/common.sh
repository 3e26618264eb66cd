# Shared by setup, test and demo: source it, do not run it. Sets `root`, the clone's folder.
#
# ROS is Debian's or Ubuntu's own, built for the system's Python; a pyenv or conda earlier on the PATH
# would be found instead and lacks its modules. Hence the plain PATH.
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
  echo build-essential cmake libeigen3-dev libgtest-dev libopencv-dev libyaml-cpp-dev nlohmann-json3-dev \
    python3-jinja2 python3-matplotlib python3-numpy python3-opencv python3-tqdm python3-yaml
  # Ubuntu 20.04 has none; CMake fetches it there.
  grep -q '^VERSION_CODENAME=focal' /etc/os-release || echo libcli11-dev
  if [ -d /opt/ros/noetic ]; then
    local name
    for name in ackermann-msgs catkin diagnostic-msgs geometry-msgs nav-msgs nodelet pluginlib rosbag \
      roscpp rosgraph-msgs roslaunch rosnode rosout rospy rosservice rostest rostopic rviz sensor-msgs \
      std-msgs std-srvs tf2 tf2-msgs tf2-py tf2-ros visualization-msgs; do
      echo "ros-noetic-$name"
    done
  else
    echo catkin libnodelet-dev libnodeletlib-dev libnodeletlib-tools pluginlib-dev librosbag-dev \
      librostest-dev libtf2-msgs-dev libtf2-ros-dev python3-diagnostic-msgs python3-nav-msgs \
      python3-rosbag python3-roslaunch python3-rosnode python3-rospy python3-rosservice python3-rostest \
      python3-rostopic python3-sensor-msgs python3-std-srvs python3-tf2 \
      python3-tf2-msgs python3-visualization-msgs ros-core-dev rosbash rosout rviz
  fi
}

# Installs the packages that are missing, and touches apt only then.
install_packages() {
  local missing=() package
  for package in $(wanted_packages); do
    [ "$(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null || true)" = "ii " ] ||
      missing+=("$package")
  done
  [ ${#missing[@]} -gt 0 ] || return 0
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q)
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "these packages are missing, and neither root nor sudo is" \
      "here to install them: ${missing[*]}"
    apt=(sudo "${apt[@]}")
  fi
  echo "installing ${#missing[@]} missing packages: ${missing[*]}"
  "${apt[@]}" update
  "${apt[@]}" install -y --no-install-recommends "${missing[@]}" ||
    fail "apt could not install them; Debian 12 and Ubuntu 20.04 with ROS Noetic have them all"
}

# As many jobs as there are cores, but each with the 1.5 GB a large source file may take.
build_jobs() {
  local cores memory
  cores=$(nproc)
  memory=$(awk '/^MemAvailable/ { print int($2 / 1500000) }' /proc/meminfo)
  echo $((memory < 1 ? 1 : memory < cores ? memory : cores))
}

# build_in FOLDER TARGET [cmake arguments]: configures when new or when arguments are given, then builds.
build_in() {
  local folder="$root/$1" target="$2"
  shift 2
  if [ ! -f "$folder/Makefile" ] || [ $# -gt 0 ]; then
    mkdir -p "$folder"
    cmake -S "$root" -B "$folder" -DPYTHON_EXECUTABLE=/usr/bin/python3 "$@" \
      >"$folder/configure.log" 2>&1 || {
      cat "$folder/configure.log" >&2
      return 1
    }
  fi
  cmake --build "$folder" --target "$target" -j "$(build_jobs)"
}
