#include "calibration/motion_noise_estimation.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

using Parameters = MotionModelParameters;
using Term = std::pair<const char*, double Parameters::*>;

constexpr int kMaxNoiseIterations = 3000;
constexpr double kNoiseTolerance = 1e-6;  // on the largest relative change of a term
constexpr double kNegligible = 1e-5;      // m or rad; smaller terms are set to 0
constexpr double kInitialSigma = 0.05;
constexpr double kMinTrajectoryNoise = 1e-6;  // m or rad; covariances stay invertible

const std::vector<Term>& termsOf(MotionNoise model) {
  static const std::vector<Term> constant{{"constant_x_sigma", &Parameters::constant_x_sigma},
                                          {"constant_y_sigma", &Parameters::constant_y_sigma},
                                          {"constant_yaw_sigma", &Parameters::constant_yaw_sigma}};
  static const std::vector<Term> differential{
      {"rotation_noise_from_rotation", &Parameters::rotation_noise_from_rotation},
      {"rotation_noise_from_translation", &Parameters::rotation_noise_from_translation},
      {"translation_noise_from_translation", &Parameters::translation_noise_from_translation},
      {"translation_noise_from_rotation", &Parameters::translation_noise_from_rotation}};
  static const std::vector<Term> ackermann{
      {"longitudinal_noise_from_translation", &Parameters::longitudinal_noise_from_translation},
      {"lateral_noise_from_translation", &Parameters::lateral_noise_from_translation},
      {"yaw_noise_from_translation", &Parameters::yaw_noise_from_translation},
      {"yaw_noise_from_rotation", &Parameters::yaw_noise_from_rotation},
      {"position_noise_from_time", &Parameters::position_noise_from_time},
      {"yaw_noise_from_time", &Parameters::yaw_noise_from_time},
      {"slip_noise_from_speed", &Parameters::slip_noise_from_speed},
      {"slip_noise_from_acceleration", &Parameters::slip_noise_from_acceleration},
      {"translation_scale_error", &Parameters::translation_scale_error},
      {"curvature_error", &Parameters::curvature_error},
      {"rotation_scale_error", &Parameters::rotation_scale_error}};
  if (model == MotionNoise::kConstant) return constant;
  return model == MotionNoise::kDifferential ? differential : ackermann;
}

Parameters withoutNoise(MotionNoise model) {
  Parameters parameters;
  parameters.motion_model = model;
  for (const Term& term : termsOf(model)) parameters.*term.second = 0.0;
  return parameters;
}

std::vector<Term> chosenTerms(MotionNoise model, const std::vector<std::string>& names) {
  std::vector<Term> chosen;
  for (const std::string& name : names) {
    const std::vector<Term>& terms = termsOf(model);
    const auto match = std::find_if(terms.begin(), terms.end(),
                                    [&](const Term& term) { return name == term.first; });
    if (match == terms.end()) {
      std::string expected;
      for (const Term& term : terms) expected += std::string(" ") + term.first;
      throw ParameterError("the motion model has no noise term '" + name + "'; expected one of" +
                           expected);
    }
    chosen.push_back(*match);
  }
  return chosen;
}

/// For each term, the covariances of all motions with that term at 1 and all others at 0.
std::vector<std::vector<Eigen::Matrix3d>> unitCovariances(const std::vector<MotionSample>& samples,
                                                          MotionNoise model,
                                                          const std::vector<Term>& terms) {
  std::vector<std::vector<Eigen::Matrix3d>> units;
  for (const Term& term : terms) {
    Parameters alone = withoutNoise(model);
    alone.*term.second = 1.0;
    units.emplace_back();
    for (const MotionSample& sample : samples) {
      units.back().push_back(motionCovariance(alone, sample.motion));
    }
  }
  return units;
}

Eigen::Matrix3d covarianceOf(const Eigen::ArrayXd& variances,
                             const std::vector<std::vector<Eigen::Matrix3d>>& units,
                             std::size_t sample, const Eigen::Matrix3d& trajectory) {
  Eigen::Matrix3d covariance = trajectory;
  for (std::size_t j = 0; j < units.size(); ++j) {
    covariance += variances[static_cast<Eigen::Index>(j)] * units[j][sample];
  }
  return covariance;
}

}  // namespace

MotionSampler::MotionSampler(Trajectory base_in_map, const OdometryParameters& odometry,
                             double max_gap)
    : base_in_map_(std::move(base_in_map)),
      odometry_(odometry),
      max_gap_(max_gap),
      next_(base_in_map_.empty() ? 0 : base_in_map_.front().stamp) {}

OdometryOutcome MotionSampler::add(const OdometrySample& sample, Nanoseconds stamp) {
  const bool first = odometry_.empty();
  const OdometryOutcome outcome = odometry_.add(sample);
  if (outcome == OdometryOutcome::kTimeJumpedBack || base_in_map_.empty()) return outcome;
  const bool used = outcome == OdometryOutcome::kUsed;
  if (!used && outcome != OdometryOutcome::kGap) return outcome;
  const auto step = static_cast<Nanoseconds>(std::llround(kStep * 1e9));
  if (first && stamp > next_) next_ += (stamp - next_ + step - 1) / step * step;
  for (; next_ <= stamp && next_ <= base_in_map_.back().stamp; next_ += step) {
    const std::optional<Pose2> pose = poseAt(base_in_map_, next_, max_gap_);
    // The motion is unknown inside gaps and before the first message.
    const bool is_known = used && !first && pose;
    nodes_.push_back(is_known ? std::optional<Node>({odometry_.at(toSeconds(next_)), *pose})
                              : std::nullopt);
  }
  return outcome;
}

std::vector<MotionSample> MotionSampler::samples(double seconds) const {
  const auto steps = static_cast<std::size_t>(std::max<long>(1, std::lround(seconds / kStep)));
  std::vector<MotionSample> samples;
  for (std::size_t end = steps; end < nodes_.size(); end += steps) {
    const auto from = nodes_.begin() + static_cast<std::ptrdiff_t>(end - steps);
    const auto to = nodes_.begin() + static_cast<std::ptrdiff_t>(end);
    if (!std::all_of(from, to + 1, [](const auto& node) { return node.has_value(); })) continue;
    MotionSample sample;
    sample.motion = motionBetween((*from)->odometry, (*to)->odometry);
    sample.seconds = static_cast<double>(steps) * kStep;
    if (sample.motion.seconds < 0.5 * sample.seconds) continue;
    const Pose2 truth = between((*from)->base_in_map, (*to)->base_in_map);
    const Pose2& delta = sample.motion.delta;
    sample.error << truth.x - delta.x, truth.y - delta.y, wrapAngle(truth.yaw - delta.yaw);
    samples.push_back(sample);
  }
  return samples;
}

std::vector<std::string> noiseTerms(MotionNoise model) {
  std::vector<std::string> names;
  for (const Term& term : termsOf(model)) names.emplace_back(term.first);
  return names;
}

MotionNoiseEstimate estimateMotionNoise(const std::vector<MotionSample>& samples, MotionNoise model,
                                        const std::vector<std::string>& names,
                                        const TrajectoryNoise& trajectory) {
  const std::vector<Term> terms = chosenTerms(model, names);
  for (const double sigma : {trajectory.position, trajectory.yaw}) {
    if (!(sigma >= kMinTrajectoryNoise && sigma <= 1000.0)) {
      std::ostringstream problem;
      problem << "the trajectory noise is " << sigma << "; it must lie in [" << kMinTrajectoryNoise
              << ", 1000] (m or rad)";
      throw ParameterError(problem.str());
    }
  }
  if (samples.empty()) throw std::invalid_argument("no motions were given");
  const auto units = unitCovariances(samples, model, terms);
  Eigen::ArrayXd variances = Eigen::ArrayXd::Constant(static_cast<Eigen::Index>(terms.size()),
                                                      kInitialSigma * kInitialSigma);
  const Eigen::Matrix3d floor = trajectory.motionCovariance();
  MotionNoiseEstimate estimate;
  double change = 1.0;
  while (change > kNoiseTolerance && estimate.iterations < kMaxNoiseIterations) {
    Eigen::ArrayXd observed = Eigen::ArrayXd::Zero(variances.size());
    Eigen::ArrayXd expected = Eigen::ArrayXd::Zero(variances.size());
    estimate.log_likelihood = 0.0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Eigen::Matrix3d covariance = covarianceOf(variances, units, i, floor);
      const Eigen::Matrix3d inverse = covariance.inverse();
      const Eigen::Vector3d normalized = inverse * samples[i].error;
      estimate.log_likelihood -=
          0.5 * (samples[i].error.dot(normalized) + std::log(covariance.determinant()) +
                 3.0 * std::log(2.0 * kPi));
      for (std::size_t j = 0; j < units.size(); ++j) {
        const auto term = static_cast<Eigen::Index>(j);
        observed[term] += normalized.dot(units[j][i] * normalized);
        expected[term] += (inverse.cwiseProduct(units[j][i])).sum();
      }
    }
    estimate.log_likelihood /= static_cast<double>(samples.size());
    // Terms that no motion excites (such as rotation terms on a straight drive) become 0.
    const Eigen::ArrayXd next =
        (expected > 0.0).select(variances * (observed / expected.max(1e-300)).sqrt(), 0.0);
    change = ((next.sqrt() - variances.sqrt()).abs() / (variances.sqrt() + kNegligible)).maxCoeff();
    variances = next;
    ++estimate.iterations;
  }
  estimate.parameters = withoutNoise(model);
  for (std::size_t j = 0; j < terms.size(); ++j) {
    const double sigma = std::sqrt(variances[static_cast<Eigen::Index>(j)]);
    estimate.parameters.*terms[j].second = sigma < kNegligible ? 0.0 : sigma;
  }
  return estimate;
}

}  // namespace racecar_mcl
