// Records a simulated drive: a bag with the car's topics, and the ground truth as a TUM file.
#pragma once

#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "evaluation/trajectory.h"
#include "offline/draft.h"
#include "ros/conversions/simulator_conversions.h"
#include "sim/simulator.h"

namespace racecar_mcl {

/// The files have temporary names until `commit`, so that an interrupted run leaves none.
class SimulationRecorder {
 public:
  /// `truth_path`: empty for no truth file. Throws std::runtime_error if a file cannot be written.
  SimulationRecorder(const std::string& bag_path, const std::string& truth_path,
                     const sim::SimulatorParameters& parameters, double start_time)
      : bag_path_(bag_path),
        bag_draft_(bag_path),
        truth_path_(truth_path),
        parameters_(parameters),
        start_time_(start_time),
        bag_(new rosbag::Bag) {
    writing([&] { bag_->open(bag_draft_.path(), rosbag::bagmode::Write); });
    if (!truth_path_.empty()) {
      truth_draft_.emplace(truth_path_);
      truth_.open(truth_draft_->path());
    }
    writeLidarExtrinsics();
  }

  /// Throws std::runtime_error if the bag cannot be written.
  void write(const sim::Event& event) {
    writing([&] { add(event); });
  }

  /// Completes the files. Throws std::runtime_error.
  void commit() {
    writing([&] { bag_->close(); });
    if (truth_draft_) {
      truth_.close();
      if (!truth_) throw std::runtime_error(truth_path_ + kCannotWrite);
      truth_draft_->commit();
    }
    bag_draft_.commit();
  }

 private:
  static constexpr char kCannotWrite[] = ": cannot be written; is the disk full?";

  /// rosbag::Bag's destructor closes the bag. It would end the process if that fails, so a bag that
  /// cannot be closed is leaked.
  struct CloseBag {
    void operator()(rosbag::Bag* bag) const noexcept {
      try {
        bag->close();
      } catch (const std::exception&) {
        return;
      }
      delete bag;
    }
  };

  template <typename Call>
  void writing(Call&& call) const {
    try {
      call();
    } catch (const rosbag::BagException& error) {
      throw std::runtime_error(bag_path_ + kCannotWrite + " (" + error.what() + ")");
    }
  }

  void add(const sim::Event& event) {
    const ros::Time arrival(event.arrival);
    if (const auto* sweep = std::get_if<sim::LidarScan>(&event.data)) {
      bag_->write(std::string("/") + kSimulatedScanTopics[sweep->lidar], arrival,
                  toMessage(*sweep));
    } else if (const auto* sample = std::get_if<OdometrySample>(&event.data)) {
      bag_->write("/vesc/odom", arrival,
                  toMessage(*sample, parameters_.odometry, "odom", "base_link"));
      tf2_msgs::TFMessage transforms;
      transforms.transforms = {
          toTransformMessage(sample->stamp, sample->base_in_odom, "odom", "base_link")};
      bag_->write("/tf", arrival, transforms);
    } else if (const auto* gyro = std::get_if<GyroSample>(&event.data)) {
      bag_->write("/imu", arrival, toMessage(*gyro, "base_link"));
    } else {
      writeTruth(std::get<sim::Truth>(event.data));
    }
  }

  void writeLidarExtrinsics() {
    tf2_msgs::TFMessage transforms;
    transforms.transforms = lidarTransforms(parameters_, start_time_);
    const auto header = boost::make_shared<ros::M_string>();
    (*header)["callerid"] = "/simulate_bag";
    (*header)["latching"] = "1";
    (*header)["topic"] = "/tf_static";
    (*header)["type"] = ros::message_traits::datatype(transforms);
    (*header)["md5sum"] = ros::message_traits::md5sum(transforms);
    (*header)["message_definition"] = ros::message_traits::definition(transforms);
    writing([&] { bag_->write("/tf_static", ros::Time(start_time_), transforms, header); });
  }

  void writeTruth(const sim::Truth& truth) {
    bag_->write("/ground_truth/odom", ros::Time(truth.stamp),
                toOdometryMessage(truth.stamp, truth.base_in_map, truth.twist, "map", "base_link"));
    if (truth_draft_) truth_ << tumLine({toNanoseconds(truth.stamp), truth.base_in_map});
  }

  std::string bag_path_;
  Draft bag_draft_;
  std::string truth_path_;
  std::optional<Draft> truth_draft_;
  sim::SimulatorParameters parameters_;
  double start_time_;
  std::unique_ptr<rosbag::Bag, CloseBag> bag_;
  std::ofstream truth_;
};

}  // namespace racecar_mcl
