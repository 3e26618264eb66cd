// Two callbacks that write the same number without a lock: ThreadSanitizer must report this race
// despite the suppressions of other people's libraries.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Int32.h>

namespace {

int count = 0;

void countUnguarded(const std_msgs::Int32ConstPtr&) { ++count; }

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "injected_race");
  ros::NodeHandle first;
  ros::NodeHandle second;
  ros::CallbackQueue second_queue;
  second.setCallbackQueue(&second_queue);
  const ros::Subscriber subscribers[] = {first.subscribe("first", 100, countUnguarded),
                                         second.subscribe("second", 100, countUnguarded)};
  const ros::Publisher publishers[] = {first.advertise<std_msgs::Int32>("first", 100),
                                       first.advertise<std_msgs::Int32>("second", 100)};
  ros::AsyncSpinner first_spinner(1);
  ros::AsyncSpinner second_spinner(1, &second_queue);
  first_spinner.start();
  second_spinner.start();
  for (int i = 0; i < 100; ++i) {
    for (const ros::Publisher& publisher : publishers) publisher.publish(std_msgs::Int32());
    ros::WallDuration(0.001).sleep();
  }
  return 0;
}
