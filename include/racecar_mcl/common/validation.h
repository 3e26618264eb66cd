// Range checks of parameters. A failed check names the parameter, its value and the allowed range.
#pragma once

#include <string>

namespace racecar_mcl {

/// All functions throw ParameterError, "NAME is VALUE UNIT; it must be EXPECTED", if the condition
/// does not hold. NaN fails every check.
void require(bool holds, const std::string& name, double value, const std::string& expected,
             const std::string& unit = "");

void requireFinite(const std::string& name, double value, const std::string& unit = "");
/// Finite and above 0.
void requirePositive(const std::string& name, double value, const std::string& unit = "");
/// Finite and at least 0.
void requireNotNegative(const std::string& name, double value, const std::string& unit = "");
/// In [low, high].
void requireWithin(const std::string& name, double value, double low, double high,
                   const std::string& unit = "");
/// In (0, max].
void requirePositiveUpTo(const std::string& name, double value, double max,
                         const std::string& unit = "");
/// In [0, 1].
void requireShare(const std::string& name, double value);

}  // namespace racecar_mcl
