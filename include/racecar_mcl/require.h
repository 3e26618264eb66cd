// How parameters refuse a value: with its name, the value, its unit and what is allowed.
#pragma once

#include <string>

namespace racecar_mcl {

/// All throw ParameterError, "NAME is VALUE UNIT; it must be EXPECTED", where their condition does
/// not hold; NaN never does.
void require(bool holds, const std::string& name, double value, const std::string& expected,
             const std::string& unit = "");

void requireFinite(const std::string& name, double value, const std::string& unit = "");
/// Finite and above 0.
void requirePositive(const std::string& name, double value, const std::string& unit = "");
/// Finite and 0 or above.
void requireNotNegative(const std::string& name, double value, const std::string& unit = "");
/// In [low, high].
void requireWithin(const std::string& name, double value, double low, double high,
                   const std::string& unit = "");
/// In (0, most].
void requirePositiveUpTo(const std::string& name, double value, double most,
                         const std::string& unit = "");
/// In [0, 1].
void requireShare(const std::string& name, double value);

}  // namespace racecar_mcl
