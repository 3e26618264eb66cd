// The localizer as a program of its own: rosrun racecar_mcl localization_node.
#include "ros/localization_node.h"

#include "ros_program.h"

int main(int argc, char** argv) {
  ros::init(argc, argv, "localization");
  return racecar_mcl::runNode<racecar_mcl::LocalizationNode>("not localizing");
}
