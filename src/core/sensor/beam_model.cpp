#include "racecar_mcl/sensor/beam_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/validation.h"
#include "simd/vector_math.h"

namespace racecar_mcl {
namespace {

struct PixelScale {
  float pixels_per_metre;
  float last;  ///< pixel
};

RACECAR_MCL_INLINE int pixelOf(const PixelScale& scale, float range) {
  const float pixel = range * scale.pixels_per_metre;
  // NaN becomes 0.
  const float positive = pixel > 0.0F ? pixel : 0.0F;
  return static_cast<int>((positive < scale.last ? positive : scale.last) + 0.5F);
}

/// Four independent partial sums hide the latency of the additions.
RACECAR_MCL_INLINE float sumOf(const float* const* rows, const int* pixels, int count) {
  std::array<float, 4> sums = {};
  int k = 0;
  for (; k + 4 <= count; k += 4) {
    sums[0] += rows[k][pixels[k]];
    sums[1] += rows[k + 1][pixels[k + 1]];
    sums[2] += rows[k + 2][pixels[k + 2]];
    sums[3] += rows[k + 3][pixels[k + 3]];
  }
  for (; k < count; ++k) sums[0] += rows[k][pixels[k]];
  return (sums[0] + sums[2]) + (sums[1] + sums[3]);
}

/// m
double pixelOf(const BeamModelParameters& parameters, double resolution) {
  return resolution * parameters.lidar_scale_to_map_scale / parameters.pixels_per_cell;
}

}  // namespace

double beamTableRange(const BeamModelParameters& parameters, double resolution) {
  return static_cast<double>(parameters.table.table_width - 1) * pixelOf(parameters, resolution);
}

void validate(const BeamModelParameters& p) {
  validate(p.table);
  requireWithin("lidar_scale_to_map_scale", p.lidar_scale_to_map_scale, 1e-3, 1e3);
  requireWithin("pixels_per_cell", p.pixels_per_cell, 1e-3, 1e3);
  requireWithin("likelihood_exponent", p.likelihood_exponent, 1e-5, 1e3);
}

BeamModel::BeamModel(const BeamModelParameters& parameters, double resolution)
    : width_(parameters.table.table_width),
      pixel_(pixelOf(parameters, resolution)),
      exponent_(parameters.likelihood_exponent) {
  validate(parameters);
  if (!(resolution > 0.0 && std::isfinite(resolution))) {
    throw ParameterError("the map's resolution is " + std::to_string(resolution) +
                         " m; it must be positive");
  }
  log_table_ = makeBeamTable(parameters.table).log().cast<float>().transpose();
}

void BeamModel::logLikelihood(const Eigen::ArrayXf& measured,
                              const Eigen::Ref<const Eigen::ArrayXXf>& expected,
                              Eigen::Ref<Eigen::ArrayXd> log_likelihood) const {
  const PixelScale scale{static_cast<float>(1.0 / pixel_), static_cast<float>(width_ - 1)};
  log_likelihood.setZero();
  std::array<const float*, kBlockSize> rows;
  for (Eigen::Index first = 0; first < measured.size(); first += kBlockSize) {
    const int count = static_cast<int>(std::min<Eigen::Index>(kBlockSize, measured.size() - first));
    for (int k = 0; k < count; ++k) {
      rows[k] = log_table_.col(pixelOf(scale, measured[first + k])).data();
    }
    runWith(fastestInstructionSet(), [&]() RACECAR_MCL_INLINE_LAMBDA {
      alignas(64) std::array<int, kBlockSize> pixels;
      for (Eigen::Index i = 0; i < expected.cols(); ++i) {
        const float* const ranges = expected.data() + i * expected.outerStride() + first;
        for (int k = 0; k < count; ++k) pixels[k] = pixelOf(scale, ranges[k]);
        log_likelihood[i] +=
            exponent_ * static_cast<double>(sumOf(rows.data(), pixels.data(), count));
      }
    });
  }
}

}  // namespace racecar_mcl
