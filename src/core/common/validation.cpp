#include "racecar_mcl/common/validation.h"

#include <cmath>
#include <sstream>

#include "racecar_mcl/common/errors.h"

namespace racecar_mcl {
namespace {

/// Ten significant digits, so that large whole numbers are not abbreviated.
std::string text(double number) {
  std::ostringstream stream;
  stream.precision(10);
  stream << number;
  return stream.str();
}

}  // namespace

void require(bool holds, const std::string& name, double value, const std::string& expected,
             const std::string& unit) {
  if (holds) return;
  throw ParameterError(name + " is " + text(value) + (unit.empty() ? "" : " " + unit) +
                       "; it must be " + expected);
}

void requireFinite(const std::string& name, double value, const std::string& unit) {
  require(std::isfinite(value), name, value, "finite", unit);
}

void requirePositive(const std::string& name, double value, const std::string& unit) {
  require(std::isfinite(value) && value > 0.0, name, value, "positive and finite", unit);
}

void requireNotNegative(const std::string& name, double value, const std::string& unit) {
  require(std::isfinite(value) && value >= 0.0, name, value, "at least 0 and finite", unit);
}

void requireWithin(const std::string& name, double value, double low, double high,
                   const std::string& unit) {
  require(value >= low && value <= high, name, value, "between " + text(low) + " and " + text(high),
          unit);
}

void requirePositiveUpTo(const std::string& name, double value, double max,
                         const std::string& unit) {
  require(value > 0.0 && value <= max, name, value, "positive and at most " + text(max), unit);
}

void requireShare(const std::string& name, double value) { requireWithin(name, value, 0.0, 1.0); }

}  // namespace racecar_mcl
