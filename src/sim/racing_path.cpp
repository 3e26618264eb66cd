#include "sim/racing_path.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "racecar_mcl/common/errors.h"
#include "racecar_mcl/common/validation.h"
#include "racecar_mcl/map/distance_field.h"

namespace racecar_mcl::sim {
namespace {

constexpr double kSpacings[] = {0.4, 0.4, 0.4, 0.2, 0.1};  // m, of the successive solutions
constexpr double kMaxOffset = 0.8;                         // m, from the path before
constexpr double kOffsetStep = 0.02;                       // m
constexpr double kMinLap = 5.0;                            // m
constexpr double kPenalty = 0.01;                          // rho of ADMM
constexpr int kIterations = 400;                           // of ADMM

std::size_t wrapped(std::ptrdiff_t index, std::size_t size) {
  const auto count = static_cast<std::ptrdiff_t>(size);
  return static_cast<std::size_t>((index % count + count) % count);
}

double lengthOf(const Path& closed) {
  double length = 0.0;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    length += (closed[(i + 1) % closed.size()] - closed[i]).norm();
  }
  return length;
}

/// Points at equal distances along the closed polyline.
Path resample(const Path& closed, double spacing) {
  const double length = lengthOf(closed);
  const auto count = static_cast<std::size_t>(std::lround(length / spacing));
  Path points;
  double begin = 0.0;
  for (std::size_t i = 0; i < closed.size(); ++i) {
    const Eigen::Vector2d way = closed[(i + 1) % closed.size()] - closed[i];
    const double end = begin + way.norm();
    for (;;) {
      const double next = length * static_cast<double>(points.size()) / static_cast<double>(count);
      if (points.size() == count || next >= end) break;
      points.emplace_back(closed[i] + way * ((next - begin) / (end - begin)));
    }
    begin = end;
  }
  return points;
}

/// The unit normals to the left.
Path normalsOf(const Path& closed) {
  Path normals;
  const std::size_t count = closed.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d tangent =
        (closed[(i + 1) % count] - closed[(i + count - 1) % count]).normalized();
    normals.emplace_back(-tangent.y(), tangent.x());
  }
  return normals;
}

/// Distances to what is not known to be free.
class Clearance {
 public:
  explicit Clearance(const OccupancyGrid& map)
      : geometry_(map.geometry()),
        cells_(clearances(obstacleMask(map, UnknownIs::kOccupied), geometry_.width,
                          geometry_.height)) {}

  /// m; a lower bound for all points of the cell.
  double at(const Eigen::Vector2d& point) const {
    const Cell cell = cellAt(geometry_, point);
    if (!contains(geometry_, cell)) return 0.0;
    return geometry_.resolution * static_cast<double>(cells_[CellIndex(geometry_)(cell)]);
  }

 private:
  GridGeometry geometry_;
  std::vector<float> cells_;
};

/// Offsets along the normals, m.
struct Bounds {
  Eigen::VectorXd lower;
  Eigen::VectorXd upper;
};

/// The interval of clear offsets around that nearest to 0.
Bounds boundsOf(const Path& path, const Path& normals, const Clearance& field, double clearance) {
  const auto count = static_cast<Eigen::Index>(path.size());
  Bounds bounds{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (std::size_t i = 0; i < path.size(); ++i) {
    const auto is_clear = [&](double offset) {
      return field.at(path[i] + offset * normals[i]) >= clearance;
    };
    double nearest = 0.0;
    while (!is_clear(nearest) && !is_clear(-nearest) && nearest <= kMaxOffset) {
      nearest += kOffsetStep;
    }
    if (nearest > kMaxOffset) {
      std::ostringstream message;
      message << "the corridor at (" << path[i].x() << ", " << path[i].y()
              << ") is too narrow for a raceline; expected a clearance of " << clearance << " m";
      throw MapError(message.str());
    }
    if (!is_clear(nearest)) nearest = -nearest;
    double lower = nearest;
    double upper = nearest;
    while (lower > -kMaxOffset && is_clear(lower - kOffsetStep)) lower -= kOffsetStep;
    while (upper < kMaxOffset && is_clear(upper + kOffsetStep)) upper += kOffsetStep;
    bounds.lower[static_cast<Eigen::Index>(i)] = lower;
    bounds.upper[static_cast<Eigen::Index>(i)] = upper;
  }
  return bounds;
}

/// The offsets a within the bounds that minimize the sum of the squared second differences of
/// p_i = path_i + a_i normal_i: a quadratic program, solved by the alternating direction method of
/// multipliers (Boyd et al., 2011).
Eigen::VectorXd solveOffsets(const Path& path, const Path& normals, const Bounds& bounds) {
  constexpr double kFourthDifference[] = {1.0, -4.0, 6.0, -4.0, 1.0};
  const std::size_t size = path.size();
  const auto count = static_cast<Eigen::Index>(size);
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Identity(count, count) * kPenalty;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(count);
  for (std::size_t i = 0; i < size; ++i) {
    for (std::ptrdiff_t k = -2; k <= 2; ++k) {
      const std::size_t j = wrapped(static_cast<std::ptrdiff_t>(i) + k, size);
      const double weight = kFourthDifference[k + 2];
      const auto row = static_cast<Eigen::Index>(i);
      hessian(row, static_cast<Eigen::Index>(j)) += weight * normals[i].dot(normals[j]);
      gradient[row] += weight * normals[i].dot(path[j]);
    }
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(hessian);
  Eigen::VectorXd bounded = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd dual = Eigen::VectorXd::Zero(count);
  for (int i = 0; i < kIterations; ++i) {
    const Eigen::VectorXd free = factor.solve(kPenalty * (bounded - dual) - gradient);
    bounded = (free + dual).cwiseMax(bounds.lower).cwiseMin(bounds.upper);
    dual += free - bounded;
  }
  return bounded;
}

}  // namespace

Path racingPath(const OccupancyGrid& map, const Path& lap, double clearance) {
  requireNotNegative("clearance of the raceline", clearance, "m");
  const double length = lengthOf(lap);
  require(length >= kMinLap, "length of the lap", length, "at least 5", "m");
  const Clearance field(map);
  Path path = lap;
  for (const double spacing : kSpacings) {
    path = resample(path, spacing);
    const Path normals = normalsOf(path);
    const Bounds bounds = boundsOf(path, normals, field, clearance);
    const Eigen::VectorXd offsets = solveOffsets(path, normals, bounds);
    for (std::size_t i = 0; i < path.size(); ++i) {
      path[i] += offsets[static_cast<Eigen::Index>(i)] * normals[i];
    }
  }
  return path;
}

}  // namespace racecar_mcl::sim
