#include "map/distance_transform.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "common/parallel.h"

namespace racecar_mcl {
namespace {

// Rows and columns per job.
constexpr int kRows = 32;
constexpr int kColumns = 2048;

int jobsOf(int size, int per_job) { return (size + per_job - 1) / per_job; }

void requireSize(const std::vector<std::uint8_t>& mask, int width, int height) {
  if (width > 0 && height > 0 &&
      mask.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    return;
  }
  throw std::invalid_argument("a mask of " + std::to_string(mask.size()) + " cells does not fit " +
                              std::to_string(width) + " x " + std::to_string(height));
}

}  // namespace

/// The minimum over parabolas (x - column)^2 + height, the squared distances from the cells of a
/// row: each parabola is the lowest from its `first` column to that of the next one.
struct DistanceTransform::Envelope {
  struct Parabola {
    int column, first;
    std::uint32_t height;
  };

  explicit Envelope(int width) : parabolas(static_cast<std::size_t>(width)) {}

  /// Adds a parabola right of all others, for the columns before `end`.
  void add(int column, std::uint32_t height, int end, const double* half_inverses) {
    int first = 0;
    for (; size > 0; --size) {
      const Parabola& last = parabolas[size - 1];
      const double rise = static_cast<double>(height) - static_cast<double>(last.height);
      // Where both are the same.
      const double same = 0.5 * (column + last.column) + rise * half_inverses[column - last.column];
      if (same >= end - 1) return;
      first = same < 0.0 ? 0 : static_cast<int>(same) + 1;
      if (first > last.first) break;
    }
    if (size == 0) first = 0;
    parabolas[size++] = {column, first, height};
  }

  std::vector<Parabola> parabolas;
  std::size_t size = 0;
};

DistanceTransform::DistanceTransform(const std::vector<std::uint8_t>& mask, int width, int height,
                                     int max_distance)
    : width_(width), height_(height), max_distance_(std::clamp(max_distance, 0, kMaxDistance)) {
  requireSize(mask, width, height);
  const auto far = static_cast<std::uint16_t>(max_distance_ + 1);
  columns_.resize(mask.size());
  std::transform(mask.begin(), mask.end(), columns_.begin(),
                 [far](std::uint8_t value) { return value != 0 ? std::uint16_t{0} : far; });
  half_inverses_.resize(static_cast<std::size_t>(width));
  for (int i = 1; i < width; ++i) half_inverses_[static_cast<std::size_t>(i)] = 0.5 / i;
  parallelFor(jobsOf(width, kColumns), [&](int job) {
    computeColumns(job * kColumns, std::min((job + 1) * kColumns, width));
  });
}

void DistanceTransform::computeColumns(int first, int last) {
  const auto spread = [&](int from, int to) {
    const std::uint16_t* const near = columns_.data() + static_cast<std::ptrdiff_t>(from) * width_;
    std::uint16_t* const cells = columns_.data() + static_cast<std::ptrdiff_t>(to) * width_;
    for (int column = first; column < last; ++column) {
      const auto next = static_cast<std::uint16_t>(near[column] + 1);
      cells[column] = next < cells[column] ? next : cells[column];
    }
  };
  for (int row = 1; row < height_; ++row) spread(row - 1, row);
  for (int row = height_ - 1; row > 0; --row) spread(row, row - 1);
}

void DistanceTransform::computeRow(int row, Envelope* envelope, std::uint32_t* squared) const {
  const std::uint16_t* const distances =
      columns_.data() + static_cast<std::ptrdiff_t>(row) * width_;
  // Cells between two that are set are nearer to these than to what is beyond them.
  for (int column = 0; column < width_;) {
    if (distances[column] == 0) {
      squared[column++] = 0;
      continue;
    }
    const std::uint16_t* const end = std::find(distances + column, distances + width_, 0);
    const int last = static_cast<int>(end - distances);
    computeRun(distances, column, last, envelope, squared);
    column = last;
  }
}

void DistanceTransform::computeRun(const std::uint16_t* distances, int begin, int end,
                                   Envelope* envelope, std::uint32_t* squared) const {
  envelope->size = 0;
  for (int column = std::max(begin - 1, 0); column < std::min(end + 1, width_); ++column) {
    const std::uint32_t distance = distances[column];
    if (distances[column] <= max_distance_) {
      envelope->add(column, distance * distance, end, half_inverses_.data());
    }
  }
  if (envelope->size == 0) return std::fill(squared + begin, squared + end, kFar);
  const auto max_squared =
      static_cast<std::uint32_t>(max_distance_) * static_cast<std::uint32_t>(max_distance_);
  for (std::size_t i = 0; i < envelope->size; ++i) {
    const Envelope::Parabola parabola = envelope->parabolas[i];
    const int last = i + 1 < envelope->size ? envelope->parabolas[i + 1].first : end;
    for (int column = std::max(parabola.first, begin); column < last; ++column) {
      const auto offset = static_cast<std::uint32_t>(std::abs(column - parabola.column));
      const std::uint32_t value = offset * offset + parabola.height;
      squared[column] = offset <= kMaxDistance && value <= max_squared ? value : kFar;
    }
  }
}

void DistanceTransform::forRows(const std::vector<int>& rows, const RowBody& body) const {
  const int count = static_cast<int>(rows.size());
  parallelFor(jobsOf(count, kRows), [&](int job) {
    Envelope envelope(width_);
    std::vector<std::uint32_t> squared(static_cast<std::size_t>(width_));
    for (int i = job * kRows; i < std::min((job + 1) * kRows, count); ++i) {
      const int row = rows[static_cast<std::size_t>(i)];
      computeRow(row, &envelope, squared.data());
      const auto first = static_cast<std::size_t>(row) * static_cast<std::size_t>(width_);
      body({row, first, squared.data()});
    }
  });
}

void DistanceTransform::forEachRow(const RowBody& body) const {
  std::vector<int> rows(static_cast<std::size_t>(height_));
  std::iota(rows.begin(), rows.end(), 0);
  forRows(rows, body);
}

int wholeCells(double cells) {
  return static_cast<int>(
      std::ceil(std::min(cells, static_cast<double>(DistanceTransform::kMaxDistance))));
}

std::vector<std::uint8_t> complement(std::vector<std::uint8_t> mask) {
  for (std::uint8_t& cell : mask) cell = cell == 0 ? 1 : 0;
  return mask;
}

namespace {

/// Sets the cells of a row up to `half` before and after one that is set (to 1); `spare` is as
/// long.
void dilateRow(std::uint8_t* cells, std::uint8_t* spare, int width, int half) {
  // The reach of each set cell grows by at most itself at a time.
  for (int reach = 0; reach < std::min(half, width);) {
    const int step = std::min(reach + 1, half - reach);
    std::copy_n(cells, width, spare);
    for (int i = step; i < width; ++i) cells[i] |= spare[i - step];
    for (int i = 0; i + step < width; ++i) cells[i] |= spare[i + step];
    reach += step;
  }
}

/// Sets the cells of the columns [first, last) up to `half` below and above one that is set in
/// `mask`.
void dilateColumns(const std::vector<std::uint8_t>& mask, int width, int height, int half,
                   int first, int last, std::vector<std::uint8_t>* result) {
  const auto far = static_cast<std::uint16_t>(std::min(half, DistanceTransform::kMaxDistance) + 1);
  std::vector<std::uint16_t> since(static_cast<std::size_t>(last - first));
  const auto mark = [&](int row) {
    const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(row) * width + first;
    const std::uint8_t* const set = mask.data() + offset;
    std::uint8_t* const marked = result->data() + offset;
    for (std::size_t i = 0; i < since.size(); ++i) {
      const auto next = static_cast<std::uint16_t>(since[i] + (since[i] < far ? 1 : 0));
      since[i] = set[i] != 0 ? std::uint16_t{0} : next;
      marked[i] |= static_cast<std::uint8_t>(since[i] < far);
    }
  };
  since.assign(since.size(), far);
  for (int row = 0; row < height; ++row) mark(row);
  since.assign(since.size(), far);
  for (int row = height - 1; row >= 0; --row) mark(row);
}

}  // namespace

std::vector<std::uint8_t> dilated(const std::vector<std::uint8_t>& mask, int width, int height,
                                  int half) {
  requireSize(mask, width, height);
  std::vector<std::uint8_t> wide(mask.size());
  parallelFor(jobsOf(height, kRows), [&](int job) {
    std::vector<std::uint8_t> spare(static_cast<std::size_t>(width));
    for (int row = job * kRows; row < std::min((job + 1) * kRows, height); ++row) {
      const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(row) * width;
      std::uint8_t* const cells = wide.data() + offset;
      std::transform(mask.data() + offset, mask.data() + offset + width, cells,
                     [](std::uint8_t value) { return value != 0 ? 1 : 0; });
      dilateRow(cells, spare.data(), width, half);
    }
  });
  std::vector<std::uint8_t> result(mask.size());
  parallelFor(jobsOf(width, kColumns), [&](int job) {
    dilateColumns(wide, width, height, half, job * kColumns, std::min((job + 1) * kColumns, width),
                  &result);
  });
  return result;
}

}  // namespace racecar_mcl
