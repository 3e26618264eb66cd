// Learns the noise of the motion models from recorded odometry and the trajectory that was driven.
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "bag_reader.h"
#include "evaluation/motion_fit.h"
#include "learned_config.h"
#include "parameter_options.h"
#include "program.h"
#include "racecar_mcl/require.h"

namespace racecar_mcl {
namespace {

constexpr std::size_t kFewestMotions = 20;

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
  std::vector<std::string> terms{"along_per_metre", "across_per_metre", "yaw_per_metre",
                                 "yaw_per_radian",  "scale_error",      "curvature_error",
                                 "turn_scale_error"};
  TrajectoryNoise trajectory_noise;
  std::string out;
};

void addOptions(Options* o, CLI::App* app) {
  app->add_option("--bag", o->bags, "a recording; may be given several times")->required();
  app->add_option("--trajectory", o->trajectory, "where the car truly was: a TUM file")->required();
  addParameterOptions(&o->parameters, app);
  app->add_option("--odom-topic", o->odom_topic, "nav_msgs/Odometry")->capture_default_str();
  app->add_option("--odom-frame", o->odom_frame, "with --motion-from tf, the odometry's frame")
      ->capture_default_str();
  app->add_option("--base-frame", o->base_frame, "with --motion-from tf, the car's frame")
      ->capture_default_str();
  app->add_option("--motion-from", o->motion_from,
                  "twist, pose or tf: what odometry is taken from");
  app->add_option("--max-gap", o->max_gap, "s that poses of the trajectory may lie apart")
      ->capture_default_str();
  app->add_option(
         "--interval", o->intervals,
         "s, length of the motions compared; several tell errors that last from those that "
         "do not. The first alone serves the models constant and differential")
      ->capture_default_str();
  app->add_option("--fit", o->terms, "terms of the ackermann model to learn; the others become 0")
      ->capture_default_str();
  app->add_option("--trajectory-sigma", o->trajectory_noise.position,
                  "m, noise of the trajectory's positions; a localizer's are good to centimetres")
      ->capture_default_str();
  app->add_option("--trajectory-yaw-sigma", o->trajectory_noise.yaw, "rad, likewise")
      ->capture_default_str();
  app->add_option(
      "--out", o->out,
      "folder for motion_noise.yaml and, to plot, motion_fit.csv [YAML to stdout only]");
}

/// A model, and the motions it was learned from.
struct Learned {
  std::string name;
  std::vector<MotionSample> samples;
  MotionFit fit;
};

MotionSampler readMotions(const Options& o, const BagReader& bags, const Trajectory& trajectory,
                          const OdometryParameters& parameters) {
  MotionSampler sampler(trajectory, parameters, o.max_gap);
  const auto take = [&](const nav_msgs::Odometry& message) {
    const Nanoseconds stamp = toNanoseconds(message.header.stamp);
    if (sampler.add(toOdometrySample(message), stamp) == OdometryOutcome::kTimeJumpedBack) {
      throw BagError("the odometry's time jumps back to " + formatStamp(stamp) +
                     " s; expected one drive whose stamps rise");
    }
  };
  if (parameters.motion_from != MotionFrom::kTf) {
    bags.requireTopic(o.odom_topic, "nav_msgs/Odometry", "--odom-topic");
    bags.forEachOdometry(o.odom_topic, take);
  } else {
    const TfFrames frames{o.odom_frame, o.base_frame, parameters.clock_jump};
    // Of the scans none are asked for.
    bags.forEach("", frames, [&](const BagEvent& event) {
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
    if (samples.size() < kFewestMotions) {
      std::ostringstream problem;
      problem << o.trajectory << ": the trajectory " << spanOf(trajectory)
              << " s and the odometry share " << samples.size() << " motions of " << o.intervals[i]
              << " s in which the car moves and poses lie at most --max-gap = " << o.max_gap
              << " s apart; expected at least " << kFewestMotions;
      throw BagError(problem.str());
    }
    all.insert(all.end(), samples.begin(), samples.end());
  }
  return all;
}

std::string yaml(const LocalizerParameters& before, const std::vector<Learned>& models) {
  LocalizerParameters learned = before;
  std::vector<std::string> names{"motion_model"};
  std::vector<std::string> comments;
  for (const Learned& model : models) {
    std::ostringstream comment;
    comment << model.name << ": learned from " << model.samples.size()
            << " motions, mean log-likelihood " << model.fit.log_likelihood;
    comments.push_back(comment.str());
    const std::map<std::string, std::string> values = parameterTexts([&] {
      LocalizerParameters all;
      all.motion = model.fit.parameters;
      return all;
    }());
    for (const std::string& name : noiseTerms(model.fit.parameters.motion_model)) {
      std::ostringstream value;
      value << toFourDigits(std::stod(values.at(name)));
      setParameter(name, value.str(), &learned);
      names.push_back(name);
    }
  }
  return configText(comments, learned, names);
}

std::string csv(const std::vector<Learned>& models, const TrajectoryNoise& trajectory) {
  std::ostringstream text;
  text.precision(9);
  text << "model,seconds,distance,rotation,error_x,error_y,error_yaw,sigma_x,sigma_y,sigma_yaw\n";
  for (const Learned& model : models) {
    for (const MotionSample& sample : model.samples) {
      const Eigen::Matrix3d covariance =
          motionCovariance(model.fit.parameters, sample.motion) + trajectory.motionCovariance();
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

void learn(const Options& o) {
  validate(o);
  LocalizerParameters parameters = readParameters(o.parameters);
  if (!o.motion_from.empty()) setParameter("motion_from", o.motion_from, &parameters);
  validate(parameters);
  const Trajectory trajectory = readTum(o.trajectory);
  const BagReader bags(o.bags);
  const MotionSampler sampler = readMotions(o, bags, trajectory, parameters.odometry);
  std::vector<Learned> models{
      {"constant", samplesOf(o, sampler, trajectory, 1), {}},
      {"differential", samplesOf(o, sampler, trajectory, 1), {}},
      {"ackermann", samplesOf(o, sampler, trajectory, o.intervals.size()), {}}};
  models[0].fit = fitMotionNoise(models[0].samples, MotionNoise::kConstant,
                                 noiseTerms(MotionNoise::kConstant), o.trajectory_noise);
  models[1].fit = fitMotionNoise(models[1].samples, MotionNoise::kDifferential,
                                 noiseTerms(MotionNoise::kDifferential), o.trajectory_noise);
  models[2].fit =
      fitMotionNoise(models[2].samples, MotionNoise::kAckermann, o.terms, o.trajectory_noise);
  writeLearned(o.out, {"motion_noise.yaml", yaml(parameters, models)},
               {"motion_fit.csv", csv(models, o.trajectory_noise)});
}

}  // namespace
}  // namespace racecar_mcl

int main(int argc, char** argv) {
  return racecar_mcl::runProgram(
      argc, argv, "learn_motion_noise",
      "Learns the noise of the motion models and prints it as a configuration.",
      racecar_mcl::addOptions, racecar_mcl::learn);
}
