# The package on ROS Noetic, installed in /opt/racecar_mcl:
#   docker build -t racecar_mcl .
#   docker run --rm -it --network host -v "$PWD:/maps" racecar_mcl localize.launch map:=/maps/basement.yaml
FROM ros:noetic-ros-base

# The key of packages.ros.org has expired in older images.
ADD https://raw.githubusercontent.com/ros/rosdistro/master/ros.key /usr/share/keyrings/ros1-latest-archive-keyring.gpg
RUN chmod 644 /usr/share/keyrings/ros1-latest-archive-keyring.gpg

WORKDIR /src/racecar_mcl
# The packages are installed before the sources are copied, so that a change of the sources does not install them again.
COPY scripts/setup scripts/
COPY scripts/lib/common.sh scripts/lib/
RUN scripts/setup --packages-only && rm -rf /var/lib/apt/lists/*

COPY . .
RUN . /opt/ros/noetic/setup.sh && \
    cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DCATKIN_ENABLE_TESTING=OFF -DPYTHON_EXECUTABLE=/usr/bin/python3 \
      -DCMAKE_INSTALL_PREFIX=/opt/racecar_mcl && \
    cmake --build build --target install -j "$(nproc)" && \
    rm -rf build .devel

# setup.bash sets the environment of /opt/racecar_mcl and of /opt/ros/noetic. `--` keeps the arguments of roslaunch from
# it, for example --help.
ENTRYPOINT ["bash", "-c", ". /opt/racecar_mcl/setup.bash -- && exec roslaunch racecar_mcl \"$@\"", "roslaunch"]
CMD ["localize.launch"]
