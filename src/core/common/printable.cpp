#include "racecar_mcl/common/printable.h"

namespace racecar_mcl {
namespace {

std::string escaped(unsigned char byte) {
  if (byte == '\n') return "\\n";
  if (byte == '\t') return "\\t";
  constexpr char kDigits[] = "0123456789abcdef";
  return {'\\', 'x', kDigits[byte >> 4], kDigits[byte & 15]};
}

bool isControl(unsigned char byte) { return byte < 0x20 || byte == 0x7f; }

}  // namespace

std::string printable(const std::string& text, std::size_t max_length) {
  std::string printed;
  for (const char character : text) {
    const auto byte = static_cast<unsigned char>(character);
    const std::string next =
        isControl(byte) || byte >= 0x80 ? escaped(byte) : std::string(1, character);
    if (printed.size() + next.size() > max_length) return printed + "...";
    printed += next;
  }
  return printed;
}

std::string withoutControlCharacters(const std::string& text) {
  std::string printed;
  for (const char character : text) {
    const auto byte = static_cast<unsigned char>(character);
    if (isControl(byte)) {
      printed += escaped(byte);
    } else {
      printed += character;
    }
  }
  return printed;
}

}  // namespace racecar_mcl
