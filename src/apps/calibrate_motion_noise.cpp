// Estimates the noise of the motion models from recorded odometry and a reference trajectory.
#include <sstream>
#include <string>
#include <vector>

#include "calibration/motion_noise_estimation.h"
#include "calibration_output.h"
#include "cli.h"
#include "file_options.h"
#include "offline/bag_reader.h"
#include "parameter_options.h"
#include "racecar_mcl/common/validation.h"

namespace racecar_mcl {
namespace {

constexpr std::size_t kMinMotions = 20;

struct Options {
  std::vector<std::string> bags;
  std::string trajectory;
  ParameterOptions parameters;
  std::string odom_topic = "/vesc/odom";
  std::string odom_frame = "odom";
  std::string base_frame = "base_link";
  std::string motion_from;
  double max_gap = 0.5;
  std::vector<double> intervals{0.1, 0.4, 1.0};  ///< s
  std::vector<std::string> terms{"longitudinal_noise_from_translation",
                                 "lateral_noise_from_translation",
                                 "yaw_noise_from_translation",
                                 "yaw_noise_from_rotation",
                                 "translation_scale_error",
                                 "curvature_error",
                                 "rotation_scale_error"};
  TrajectoryNoise trajectory_noise;
  std::string out;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--bag", o->bags, "recorded bag; may be repeated")->required();
  app->add_option("--trajectory", o->trajectory, "reference trajectory, a TUM file")->required();
  addParameterOptions(&o->parameters, app);
  app->add_option("--odom-topic", o->odom_topic, "nav_msgs/Odometry")->capture_default_str();
  app->add_option("--odom-frame", o->odom_frame, "odometry frame, with --motion-from tf")
      ->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "car frame, with --motion-from tf")
      ->capture_default_str();
  app->add_option("--motion-from", o->motion_from, "source of odometry: twist, pose or tf");
  app->add_option("--max-gap", o->max_gap, "maximum interval between trajectory poses, s")
      ->capture_default_str();
  app->add_option(
         "--interval", o->intervals,
         "durations of motions, s; several durations separate systematic from random errors. The "
         "models constant and differential use the first only")
      ->capture_default_str();
  app->add_option("--fit", o->terms, "ackermann terms to estimate; the others become 0")
      ->capture_default_str();
  app->add_option("--trajectory-sigma", o->trajectory_noise.position,
                  "position noise of the trajectory, m; centimetres if it is from a localizer")
      ->capture_default_str();
  app->add_option("--trajectory-yaw-sigma", o->trajectory_noise.yaw,
                  "heading noise of the trajectory, rad")
      ->capture_default_str();
  app->add_option(
      "--out", o->out,
      "output folder for motion_noise.yaml and motion_noise.csv (for plots) [print YAML only]");
}

/// A motion model and the motions it is estimated from.
struct EstimatedModel {
  std::string name;
  std::vector<MotionSample> samples;
  MotionNoiseEstimate estimate;
};

MotionSampler readMotions(const Options& o, const BagReader& bags, const Trajectory& trajectory,
                          const OdometryParameters& parameters) {
  MotionSampler sampler(trajectory, parameters, o.max_gap);
  const auto take = [&](const nav_msgs::Odometry& message) {
    const Nanoseconds stamp = toNanoseconds(message.header.stamp);
    if (sampler.add(toOdometrySample(message), stamp) == OdometryOutcome::kTimeJumpedBack) {
      throw BagError("the odometry's time jumps back to " + formatStamp(stamp) +
                     " s; expected one drive with increasing stamps");
    }
  };
  if (parameters.motion_from != MotionFrom::kTf) {
    bags.requireTopic(o.odom_topic, "nav_msgs/Odometry", "--odom-topic");
    bags.forEachOdometry(o.odom_topic, take);
  } else {
    const TfFrames frames{o.odom_frame, o.base_frame, parameters.clock_jump};
    // No scans.
    bags.forEach({{}, ""}, frames, [&](const BagEvent& event) {
      if (event.odometry) take(*event.odometry);
    });
  }
  return sampler;
}

std::vector<MotionSample> samplesOf(const Options& o, const MotionSampler& sampler,
                                    const Trajectory& trajectory, std::size_t intervals) {
  std::vector<MotionSample> all;
  for (std::size_t i = 0; i < intervals; ++i) {
    const std::vector<MotionSample> samples = sampler.samples(o.intervals[i]);
    if (samples.size() < kMinMotions) {
      std::ostringstream problem;
      problem << o.trajectory << ": trajectory " << spanOf(trajectory) << " s and odometry have "
              << samples.size() << " motions of " << o.intervals[i] << " s; expected at least "
              << kMinMotions << " of a moving car, with poses at most --max-gap = " << o.max_gap
              << " s apart";
      throw BagError(problem.str());
    }
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return all;
}

std::string yaml(const LocalizerParameters& before, const std::vector<EstimatedModel>& models) {
  LocalizerParameters estimated = before;
  std::vector<std::string> names{"motion_model"};
  std::vector<std::string> comments;
  for (const EstimatedModel& model : models) {
    std::ostringstream comment;
    comment << model.name << ": estimated from " << model.samples.size()
            << " motions, mean log-likelihood " << model.estimate.log_likelihood;
    comments.push_back(comment.str());
    const std::map<std::string, std::string> values = parameterTexts([&] {
      LocalizerParameters all;
      all.motion = model.estimate.parameters;
      return all;
    }());
    for (const std::string& term : noiseTerms(model.estimate.parameters.motion_model)) {
      const std::string name = values.count(term) ? term : "expert/" + term;
      std::ostringstream value;
      value << toFourDigits(std::stod(values.at(name)));
      setParameter(name, value.str(), &estimated);
      names.push_back(name);
    }
  }
  return configText(comments, estimated, names);
}

std::string csv(const std::vector<EstimatedModel>& models, const TrajectoryNoise& trajectory) {
  std::ostringstream text;
  text.precision(9);
  text << "model,seconds,distance,rotation,error_x,error_y,error_yaw,sigma_x,sigma_y,sigma_yaw\n";
  for (const EstimatedModel& model : models) {
    for (const MotionSample& sample : model.samples) {
      const Eigen::Matrix3d covariance =
          motionCovariance(model.estimate.parameters, sample.motion) +
          trajectory.motionCovariance();
      const Eigen::Array3d sigma = covariance.diagonal().array().sqrt();
      text << model.name << ',' << sample.seconds << ',' << sample.motion.distance << ','
           << sample.motion.rotation;
      for (int i = 0; i < 3; ++i) text << ',' << sample.error[i];
      for (int i = 0; i < 3; ++i) text << ',' << sigma[i];
      text << '\n';
    }
  }
  return text.str();
}

void validate(const Options& o) {
  requirePositive("--max-gap", o.max_gap, "s");
  for (const double interval : o.intervals) {
    requireWithin("--interval", interval, MotionSampler::kStep, 60.0, "s");
  }
}

void calibrate(const Options& o) {
  validate(o);
  std::vector<std::string> inputs = o.bags;
  inputs.insert(inputs.end(), {o.trajectory, o.parameters.config});
  requireSeparateFiles(filesIn(o.out, {"motion_noise.yaml", "motion_noise.csv"}), inputs);
  LocalizerParameters parameters = readParameters(o.parameters);
  if (!o.motion_from.empty()) setParameter("motion_from", o.motion_from, &parameters);
  validate(parameters);
  const Trajectory trajectory = readTum(o.trajectory);
  const BagReader bags(o.bags);
  const MotionSampler sampler = readMotions(o, bags, trajectory, parameters.odometry);
  std::vector<EstimatedModel> models{
      {"constant", samplesOf(o, sampler, trajectory, 1), {}},
      {"differential", samplesOf(o, sampler, trajectory, 1), {}},
      {"ackermann", samplesOf(o, sampler, trajectory, o.intervals.size()), {}}};
  models[0].estimate = estimateMotionNoise(models[0].samples, MotionNoise::kConstant,
                                           noiseTerms(MotionNoise::kConstant), o.trajectory_noise);
  models[1].estimate =
      estimateMotionNoise(models[1].samples, MotionNoise::kDifferential,
                          noiseTerms(MotionNoise::kDifferential), o.trajectory_noise);
  models[2].estimate =
      estimateMotionNoise(models[2].samples, MotionNoise::kAckermann, o.terms, o.trajectory_noise);
  writeCalibration(o.out, {"motion_noise.yaml", yaml(parameters, models)},
                   {"motion_noise.csv", csv(models, o.trajectory_noise)});
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "calibrate_motion_noise",
      "Estimates the noise of the motion models and prints it as a configuration.",
      racecar_mcl::addOptions, racecar_mcl::calibrate);
}
