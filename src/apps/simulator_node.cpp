// The simulated car as a program of its own: rosrun racecar_mcl simulator_node.
#include "ros/simulator_node.h"

#include "ros_program.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "simulator");
  return racecar_mcl::runNode<racecar_mcl::SimulatorNode>("not simulating");
}
