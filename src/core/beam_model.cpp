#include "racecar_mcl/beam_model.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "racecar_mcl/errors.h"

namespace racecar_mcl {

void validate(const BeamModelParameters& p) {
  validate(p.table);
  const std::pair<const char*, double> positive[] = {
      {"lidar_scale_to_map_scale", p.lidar_scale_to_map_scale},
      {"pixels_per_cell", p.pixels_per_cell},
      {"squash_factor", p.squash_factor}};
  for (const auto& [name, value] : positive) {
    if (!(value >= 1e-3 && value <= 1e3)) {
      std::ostringstream problem;
      problem << name << " is " << value << "; it must lie in [0.001, 1000]";
      throw ParameterError(problem.str());
    }
  }
}

BeamModel::BeamModel(const BeamModelParameters& parameters, double resolution)
    : width_(parameters.table.table_width),
      pixel_(resolution * parameters.lidar_scale_to_map_scale / parameters.pixels_per_cell),
      squash_(1.0 / parameters.squash_factor) {
  validate(parameters);
  if (!(resolution > 0.0 && std::isfinite(resolution))) {
    throw ParameterError("the map's resolution is " + std::to_string(resolution) +
                         " m; it must be positive");
  }
  log_table_ = makeSensorTable(parameters.table).log().cast<float>().transpose();
}

void BeamModel::logLikelihood(const Eigen::ArrayXf& measured,
                              const Eigen::Ref<const Eigen::ArrayXXf>& expected,
                              Eigen::Ref<Eigen::ArrayXd> log_likelihood) const {
  const auto beams = measured.size();
  const float last = static_cast<float>(width_ - 1);
  const float pixels_per_metre = static_cast<float>(1.0 / pixel_);
  const auto pixelOf = [&](float range) {
    // std::max returns its first argument where the second is NaN.
    return static_cast<int>(std::min(std::max(0.0f, range * pixels_per_metre), last) + 0.5f);
  };
  std::vector<const float*> rows(static_cast<std::size_t>(beams));
  for (Eigen::Index k = 0; k < beams; ++k) {
    rows[static_cast<std::size_t>(k)] = log_table_.col(pixelOf(measured[k])).data();
  }
  for (Eigen::Index i = 0; i < expected.cols(); ++i) {
    float sum = 0.0f;
    for (Eigen::Index k = 0; k < beams; ++k) {
      sum += rows[static_cast<std::size_t>(k)][pixelOf(expected(k, i))];
    }
    log_likelihood[i] = squash_ * static_cast<double>(sum);
  }
}

}  // namespace racecar_mcl
