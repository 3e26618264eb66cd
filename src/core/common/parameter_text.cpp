#include "racecar_mcl/common/parameter_text.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <iterator>
#include <sstream>

#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {
namespace {

/// Reads a value from the whole text; false if the text is not a value of this type.
template <typename Value>
bool parse(const std::string& text, Value* value) {
  std::istringstream stream(text);
  Value read;
  if (!(stream >> read) || !(stream >> std::ws).eof()) return false;
  *value = read;
  return true;
}

}  // namespace

void refuseParameter(const std::string& name, const std::string& text,
                     const std::string& expected) {
  throw ParameterError(printable(name) + " is '" + printable(text) + "'; expected " + expected);
}

void parseParameter(const std::string& name, const std::string& text, double* value) {
  if (!parse(text, value)) refuseParameter(name, text, "a number");
}

void parseParameter(const std::string& name, const std::string& text, int* value) {
  if (!parse(text, value)) refuseParameter(name, text, "a whole number");
}

void parseParameter(const std::string& name, const std::string& text, bool* value) {
  // The spellings of YAML, in any case, and those of roslaunch and XML-RPC.
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  const auto isOneOf = [&](std::initializer_list<const char*> words) {
    return std::find(words.begin(), words.end(), lower) != words.end();
  };
  const bool is_true = isOneOf({"true", "yes", "y", "on", "1"});
  if (!is_true && !isOneOf({"false", "no", "n", "off", "0"})) {
    refuseParameter(name, text, "true or false");
  }
  *value = is_true;
}

void parseParameter(const std::string& /*name*/, const std::string& text, std::string* value) {
  *value = text;
}

void parseParameter(const std::string& /*name*/, const std::string& text,
                    std::vector<std::string>* value) {
  std::istringstream words(text);
  value->assign(std::istream_iterator<std::string>(words), {});
}

std::string parameterText(double value) {
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::digits10);
  text << value;
  return text.str();
}

std::string parameterText(int value) { return std::to_string(value); }
std::string parameterText(bool value) { return value ? "true" : "false"; }
std::string parameterText(const std::string& value) { return value; }

std::string parameterText(const std::vector<std::string>& value) {
  std::string text;
  for (const std::string& word : value) text += (text.empty() ? "" : " ") + word;
  return text;
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

}  // namespace racecar_mcl
